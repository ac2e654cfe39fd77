"""Names that documents and the comments of TOML files use, asked of the program: labels, columns, keys, options.

A document may use a name only as the program does, so these are its rules:
- `key=value` in code font, in a cell of a table or in a comment of a TOML file is a setting of a method. A method's name in
  front makes it a label, which the program has to accept. "`METHOD` with `key=value`" is a part of one of its labels, and
  without a method it is a part of a label of some method that the document names. Parts may lack settings that others need.
- "column `x`", "columns `x` and `y`", "`table.csv`: `x`" and "`x` of `table.csv`" name columns, "key `x`" keys of experiments.
- `key = "value"` and `[table]` are lines of experiments, or of the TOML files that the document's folder has.
- `--option` belongs to the program or to a script. In comments of TOML files this holds without code font, too.
- A word with an underscore, such as `rel_mse`, is printed by the program or stands in a source file. In documents for users
  every word is a name that the program prints, a text in its source, or a file. Words shorter than three letters are symbols.
Capitals stand for something else, as in `gather=N`; so does what follows `--set`, which is a parameter of a scene.
"""
import functools
import glob
import itertools
import os
import re
import subprocess

from readme_checks import PROGRAMS, Span, is_placeholder, is_script, read, take_spans

PAIR = r"(?<![\w.\-/$=?&])[a-z]\w*=(?!=)[\w.+-]*\w(?:,[\w.+-]*\w)*"
LABEL = re.compile(rf"(?:(?<![\w.-])([a-z]\w*)\s+)?({PAIR}(?:\s+{PAIR})*)")
METHOD_BEFORE = re.compile(r"(\w+)`?\s+(?:with\s+|\()?`?$")
LIST = r"(?P<names>`[^`]+`(?:(?:,\s*|\s+)(?:(?:and|or)\s+)?`[^`]+`)*)"
FILE = r"(?P<file>`?[\w-]+\.\w+`?)"
OTHERS = r"(?P<others>\b(?:components?|stages?)\s+)?"
WORD = r"[a-z]{3}[a-z0-9_]*(?:\.\d[a-z0-9_]*)?"
FOR_USERS = re.compile(r"README\.md|experiments/[\w-]+\.(md|toml)")


class Comments:
    """The comments of a TOML file, in the form of a Document."""

    def __init__(self, root, name):
        self.name, self.folder = name, os.path.dirname(name)
        text = read(os.path.join(root, name))
        self.code = re.sub(r"(\"\"\"|''').*?\1", lambda match: "\n" * match[0].count("\n"), text, flags=re.DOTALL)
        lines = [re.fullmatch(r"((?:[^\"'#]|\"[^\"]*\"|'[^']*')*)(?:#(.*))?", line) for line in self.code.split("\n")]
        self.code = "\n".join(line[1] if line else "" for line in lines)
        self.marked_prose = "\n".join(line[2] or "" if line else "" for line in lines)
        self.prose, self.spans = take_spans(self.marked_prose)


def line_of(text, start):
    return 1 + text.count("\n", 0, start)


def fields_of(document):
    """The parts of a document in which labels stand: code spans, cells of tables, comments."""
    yield from document.spans
    is_field = r"(?:.+\n?)+" if isinstance(document, Comments) else r"(?<=\|)[^|\n]+(?=\|)"
    for match in re.finditer(is_field, document.prose):
        yield Span(line_of(document.prose, match.start()), match[0])


class Names:
    """Each check yields lines `document:line: what: why`, as those of Checker do."""

    def __init__(self, checker):
        self.checker = checker
        self.documents = checker.documents + [Comments(checker.root, name) for name in checker.files
                                              if name.endswith(".toml")]
        self.answers = {}  # of the program to labels

    def ask(self, *words):
        return subprocess.run([self.checker.program, *words], capture_output=True, text=True, check=False, timeout=60,
                              cwd=self.checker.root, stdin=subprocess.DEVNULL)

    # What the program prints

    @functools.cached_property
    def lists(self):
        """Of each list its sections, and of each section its names with what stands behind them."""
        found = {}
        for name in ("methods", "scenes", "effects", "experiments", "keys", "columns"):
            sections = found[name] = {}
            for line in self.ask("list", name, *["--parameters"][:name == "methods"]).stdout.splitlines():
                first, _, rest = re.sub(r"^(\[+\w+\]+)( with a command)?", r"\1", line.strip()).partition(" ")
                if not line.startswith(" "):
                    section = sections.setdefault(first, {})
                else:
                    section[first] = rest
        for method, parameters in found["methods"].items():
            parameters.update(found["methods"]["every"])
        return found

    @functools.cached_property
    def methods(self):
        return {name: parameters for name, parameters in self.lists["methods"].items() if name != "every"}

    @functools.cached_property
    def options(self):
        """The options of every command and script."""
        texts = [self.ask("completion", "bash").stdout]
        texts += map(read, filter(os.path.isfile, glob.glob(os.path.join(self.checker.root, "scripts/*"))))
        return set(re.findall(r"(?<![\w-])--[a-z][\w-]*", "".join(texts)))

    @functools.cached_property
    def printed(self):
        """Names that the program prints."""
        words = {*PROGRAMS, *re.findall(r"[\w-]+", self.ask("completion", "bash").stdout)}
        return words.union(*self.lists.values(), *itertools.chain(*(one.values() for one in self.lists.values())))

    @functools.cached_property
    def source(self):
        """The words of all files but documents and tests of documents, and the texts of one word in the program."""
        words, texts = set(), set()
        for name in self.checker.files:
            if name.endswith((".md", ".toml")) or name.startswith("tests/scripts/"):
                continue
            try:
                text = read(os.path.join(self.checker.root, name))
            except UnicodeDecodeError:
                continue
            words |= set(re.findall(r"\w+", text))
            if name.startswith(("common/", "methods/", "experiments/", "scripts/")) and not name.endswith(".js"):
                texts |= set(re.findall(r"\"(\w+)\"", text))
        return words, texts

    def is_foreign(self, text):
        """Whether it is a command of another program, whose options and pairs are its own."""
        first = text.split()[0]
        return re.match(r"[\w.-]+\s.*(?<!\S)-", text) and first not in self.printed and not is_script(first)

    # Labels

    def named_methods(self, document):
        """The methods that a document names; all of them if it names none."""
        words = set(re.findall(r"\w+", f"{document.folder} {document.marked_prose} {document.code}"))
        return [method for method in self.methods if method in words] or list(self.methods)

    def refused_labels(self):
        for document in self.documents:
            for field in fields_of(document):
                for line, label, why in self.refused_in(field, document):
                    yield f"{document.name}:{field.line + line - 1}: {label}: {why}"

    def refused_in(self, field, document):
        if field in document.spans and self.is_foreign(field.text):
            return
        text = re.sub(r"--set\s+\S+", lambda match: " " * len(match[0]), field.text)
        for match in re.finditer(r"--method[ =][\"']?([a-z]\w*)", text):
            if match[1] not in self.methods:
                yield line_of(text, match.start()), match[1], "there is no such method"
        for match in LABEL.finditer(text):
            pairs = [pair.partition("=")[::2] for pair in match[2].split()]
            named = METHOD_BEFORE.search(field.before + text[:match.start(2)])
            is_label = match[1] and field in document.spans and match[0] == text.strip(' "')
            if is_label or match[1] in self.methods:
                why = self.refusal(match[1], pairs, is_whole=True)
            elif named and named[1] in self.methods:
                why = self.refusal(named[1], pairs, is_whole=False)
            else:
                why = self.refusal_of_part(self.named_methods(document), pairs)
            if why:
                yield line_of(text, match.start(2)), " ".join(match[0 if is_label else 2].split()), why

    def refusal_of_part(self, methods, pairs):
        """Why some methods refuse a part of a label, of which one would be enough to take it."""
        able = [method for method in methods if all(key in self.methods[method] for key, _ in pairs)]
        if not able:
            return "no method that the document names has these parameters"
        refusals = [self.refusal(method, pairs, is_whole=False) for method in able]
        return None if None in refusals else refusals[0]

    def refusal(self, method, pairs, is_whole):
        """Why the program refuses a label. Of values to search, 0.1..0.2 and cone,gaussian, it is asked one by one."""
        for key, _ in pairs:
            if method in self.methods and key not in self.methods[method]:
                return f"{method} has no parameter {key}"
        choices = [[f"{key}={value}" for value in re.split(r"\.\.|,", values)] for key, values in pairs
                   if not re.fullmatch(r"[A-Z]+", values)]
        whole = is_whole and len(choices) == len(pairs)
        refusals = (self.refusal_of_label(method, settings, whole) for settings in itertools.product(*choices))
        return next(filter(None, refusals), None)

    def refusal_of_label(self, method, settings, is_whole):
        """What the program says of it. A part is completed by what its settings need to have an effect."""
        label = " ".join((method, *settings))
        if label not in self.answers:
            run = self.ask("plan", "cornell-box", "--method", label)
            self.answers[label] = run.stderr.strip() if run.returncode else None
        answer = self.answers[label]
        needs = re.search(r"has no effect with (\w+)=(\w+)$", answer or "")
        if is_whole or not needs or any(setting.startswith(needs[1] + "=") for setting in settings):
            return answer
        words = re.search(r"\((\w+(?:\|\w+)+);", self.methods[method][needs[1]])
        others = [word for word in words[1].split("|") if word != needs[2]] if words else ["1"]
        return self.refusal_of_label(method, (*settings, f"{needs[1]}={others[0]}"), is_whole=False)

    # Columns, keys, options and other words

    def listed(self, *patterns):
        """The names in code font that patterns list, each with its document, its place and the file that is said."""
        found = {}
        for document, pattern in itertools.product(self.documents, patterns):
            for match in re.finditer(pattern, document.marked_prose):
                place = f"{document.name}:{line_of(document.marked_prose, match.start('names'))}"
                groups = match.groupdict(default="")
                for name in re.findall(r"`([a-z]\w*(?:\.\d\w*)?)`", match["names"] * (not groups.get("others"))):
                    file = groups.get("file", "").strip("`")
                    found[place, name, file] = (document, place, name, file)
        return found.values()

    def unknown_columns(self):
        tables = self.lists["columns"]
        tables = {"": set().union(*tables.values()), **tables}
        for _, place, name, file in self.listed(
                rf"\bcolumns?\s+{LIST}(?:\s+(?:of|in)\s+{FILE})?", rf"{LIST}\s+columns?\b(?:\s+(?:of|in)\s+{FILE})?",
                rf"{OTHERS}{LIST}\s+(?:of\s+|in\s+|\(){FILE}", rf"{FILE}(?::\s+|\s+\(){LIST}"):
            if name not in tables.get(file, name):
                yield f"{place}: {name}: {f'{file} has no' if file else 'no CSV file has'} such column"
        for document in self.documents:
            for span in document.spans:
                for names in re.findall(rf"--columns[ =]({WORD}(?:,{WORD})*)", span.text):
                    for name in set(names.split(",")) - tables[""] - self.source[1]:
                        yield f"{document.name}:{span.line}: {name}: --columns has no such column"

    def unknown_keys(self):
        tables = {name.strip("[]"): set(section) for name, section in self.lists["keys"].items()}
        tables["reference"] |= set().union(*self.methods.values())
        keys = set().union(*tables.values())
        of_tests = {word for comments in self.documents if isinstance(comments, Comments)
                    and comments.name.startswith("tests/") for word in re.findall(r"\w+", comments.code)}
        found = [(document, place, name, keys) for document, place, name, file in self.listed(
            rf"\bkeys?\s+{LIST}(?:\s+(?:of|in)\s+{FILE})?", rf"{LIST}\s+(?:of|in)\s+(?:an?|the)\s+`\[")
                 if file.endswith(".toml") or not file]
        for document in self.documents:
            for span in document.spans:
                place = f"{document.name}:{span.line}"
                line = re.fullmatch(rf"({WORD}) = (?:\".*\"|\[.*\]|{{.*}}|[\d.]+|true|false)|\[+({WORD})\]+", span.text)
                if line:
                    found.append((document, place, line[1] or line[2], keys if line[1] else tables))
                    found += [(document, place, name, tables.get(line[1], ()))
                              for name in re.findall(rf"[{{,] ?({WORD}) =", span.text)]
        for document, place, name, known in found:
            if name not in known and not (document.name.startswith("tests/") and name in of_tests):
                yield f"{place}: {name}: experiment files have no such key there"

    def unknown_options(self):
        for document in self.documents:
            fields = [Span(1, document.prose)] * isinstance(document, Comments)
            for field in fields + [span for span in document.spans if not self.is_foreign(span.text)]:
                text = re.sub(r"\"[^\"]*\"", lambda match: " " * len(match[0]), field.text)
                for match in re.finditer(r"(?<![\w-])--[a-z][\w-]*", text):
                    if match[0] not in self.options:
                        line = field.line + line_of(text, match.start()) - 1
                        yield f"{document.name}:{line}: {match[0]}: neither program nor scripts have this option"

    def unknown_words(self):
        words, texts = self.source
        for document in self.documents:
            is_for_users = FOR_USERS.fullmatch(document.name)
            own = self.printed | set(re.findall(r"\w+", document.code))
            for span in document.spans:
                if not re.fullmatch(WORD, span.text) or is_placeholder(span.text):
                    continue
                is_known = span.text in own or os.path.exists(os.path.join(self.checker.root, span.text))
                if is_for_users and not is_known and span.text not in texts:
                    yield f"{document.name}:{span.line}: {span.text}: the program does not have this word"
                elif "_" in span.text and not is_known and span.text not in words:
                    yield f"{document.name}:{span.line}: {span.text}: no file of the repository has this word"

    def wrong_commands(self):
        """Commands and scripts in comments of TOML files, and scenes and experiments that commands call by name."""
        comments = [document for document in self.documents if isinstance(document, Comments)]
        yield from self.checker.wrong_inline_commands(comments)
        for document in comments:
            for match in re.finditer(r"(?<![\w./])(?:\./)?(scripts/[\w./-]*\w)", document.prose):
                if not os.path.exists(os.path.join(self.checker.root, match[1])):
                    yield f"{document.name}:{line_of(document.prose, match.start())}: {match[1]}: there is no such script"
        for document in self.documents:
            for span in document.spans:
                call = re.match(r"(?:\S*/)?gibench (run|render|plan|photons|reference|tune) ([a-z][\w-]*)(?= |$)", span.text)
                if call and call[2] not in self.lists["experiments" if call[1] == "run" else "scenes"]:
                    yield f"{document.name}:{span.line}: {span.text}: nothing has the name {call[2]}"
