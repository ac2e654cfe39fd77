"""Checks of Markdown files: links, named files, commands, experiment files. readme_test.py runs them."""
import csv
import glob
import importlib.util
import json
import os
import re
import shlex
import signal
import subprocess
import tempfile
import urllib.parse
from typing import NamedTuple

TOPS = ("common", "methods", "experiments", "scenes", "tests", "scripts")
SHELL = ("indented", "sh", "")
PROGRAMS = ("gibench", "build/release/experiments/gibench")
NOTHING = "nothing-has-this-name"
TINY = """scenes = [{scenes}]
resolution = [16, 16]
seeds = 2
[budget]
passes = 8
[reference]
target = "20%"
seconds = 5
[[method]]
name = "path"
spp = [1, 8]
[[method]]
name = "photon_mapper"
photons = 100
"""


def read(path):
    with open(path, encoding="utf-8") as file:
        return file.read()


def files_of(root):
    """All files of the repository, relative to its top, without results and what builds make."""
    listing = subprocess.run(["git", "-C", root, "ls-files", "--cached", "--others", "--exclude-standard"],
                             capture_output=True, text=True, check=False)
    if listing.returncode == 0:
        return sorted(name for name in listing.stdout.splitlines() if os.path.isfile(os.path.join(root, name)))
    found = []
    for folder, folders, names in os.walk(root):
        folders[:] = [name for name in folders if name not in ("build", "results", ".git")]
        found += [os.path.relpath(os.path.join(folder, name), root) for name in names]
    return sorted(found)


class Block(NamedTuple):
    language: str  # language of a fence; "indented": four spaces
    lines: list  # (line number, text)

    def text(self):
        return "".join(text + "\n" for _, text in self.lines)

    def commands(self):
        """(line number, command); a line that ends with a backslash goes on in the next one."""
        start, command = 0, ""
        for number, text in self.lines:
            start, command = (start, command + text.strip()) if command else (number, text.strip())
            if command.endswith("\\"):
                command = command[:-1]
                continue
            if command:
                yield start, command
            command = ""


class Span(NamedTuple):
    line: int
    text: str
    before: str = ""  # what stands before it in its paragraph


def take_spans(text):
    """The text with its code spans blanked out, and these."""
    spans = []

    def blank(match):
        before = text[:match.start()].rpartition("\n\n")[2]
        spans.append(Span(1 + text.count("\n", 0, match.start()), " ".join(match[2].split()), before))
        return re.sub(r"[^\n]", " ", match[0])

    return re.sub(r"(?<!`)(`+)(?!`)((?:(?!\n\s*\n).)+?)(?<!`)\1(?!`)", blank, text, flags=re.DOTALL), spans


class Document:
    """A Markdown file: its code blocks, its code spans, and its prose with everything that is code blanked out."""

    def __init__(self, root, name):
        self.name = name
        self.folder = os.path.dirname(name)
        self.blocks = []
        prose, fence, after_blank, in_list = [], None, True, False
        for number, line in enumerate(read(os.path.join(root, name)).splitlines(), 1):
            mark = re.match(r"\s*(```+|~~~+)\s*(\w*)", line)
            # In a list, four spaces may only continue an item, so that there only a command counts as code.
            indented = (not fence and not mark and line.startswith("    ") and after_blank
                        and (not in_list or is_command(line.strip())))
            if fence:
                if mark and mark[1].startswith(fence) and not mark[2]:
                    fence = None
                else:
                    self.blocks[-1].lines.append((number, line))
            elif mark:
                fence = mark[1]
                self.blocks.append(Block(mark[2], []))
            elif indented:
                if after_blank is True:
                    self.blocks.append(Block("indented", []))
                self.blocks[-1].lines.append((number, line[4:]))
            else:
                prose.append(line)
                after_blank = not line.strip()
                if line.strip() and not line.startswith(" "):
                    in_list = bool(re.match(r"([-*+]|\d+\.)\s", line))
                continue
            prose.append("")
            after_blank = "code" if indented else True
        self.marked_prose = "\n".join(prose)
        self.prose, self.spans = take_spans(self.marked_prose)
        self.code = "".join(block.text() for block in self.blocks)

    def anchors(self):
        """GitHub's names of the headings."""
        found, seen = set(), {}
        for heading in re.findall(r"^#{1,6}\s+(.*?)\s*#*$", self.marked_prose, re.MULTILINE):
            heading = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", heading)
            slug = re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")
            seen[slug] = seen.get(slug, -1) + 1
            found.add(f"{slug}-{seen[slug]}" if seen[slug] else slug)
        return found | set(re.findall(r"<a\s+(?:name|id)=\"([^\"]+)\"", self.prose))

    def links(self):
        for pattern in (r"\]\(\s*<?([^)\s>]+)", r"^\s*\[[^\]]+\]:\s*(\S+)", r"\b(?:src|href)=\"([^\"]+)\""):
            for match in re.finditer(pattern, self.prose, re.MULTILINE):
                yield 1 + self.prose.count("\n", 0, match.start(1)), match[1]


def words_of(command):
    """The words of a command without its comment, assignments of environment variables and surplus quotes."""
    try:
        words = shlex.split(command, comments=True)
    except ValueError:
        words = re.sub(r"\s#\s.*", "", command).split()
    while words and re.fullmatch(r"[A-Za-z_]\w*=.*", words[0]):
        words.pop(0)
    return words


def is_script(word):
    return re.fullmatch(r"(\./)?scripts/[\w-]+", word) is not None


def is_command(text):
    words = words_of(text)
    return bool(words) and (words[0] in (*PROGRAMS, "ctest", "cmake") or is_script(words[0]))


def is_placeholder(text):
    """Whether it stands for something else: NAME, <name>, [options], ..."""
    capitals = r"(?<![A-Za-z])(?!README|LICENSE|CONTRIBUTING)[A-Z]{2,}(?![a-z])"
    return re.search(capitals + r"|[<>\[\]|$]|\.\.\.|…", text) is not None


def exit_codes(command):
    """The exit codes that a comment such as `# exit code 0: the same, 1: different, 2: wrong input` allows."""
    comment = re.search(r"\s#\s.*?exit code (\d+)(.*)", command)
    if not comment:
        return {0}
    further = {int(code) for code in re.findall(r"[,;] (?:or )?(\d+)(?=:|$)", comment[2])}
    return {int(comment[1])} | further - {2}  # commands of a README never have wrong input, except to show that


def results_named(command):
    return re.findall(r"(?<![\w/.-])results/([\w.-]+)", command)


class Checker:
    """Checks of the documents of one repository. Each yields lines `document:line: what: why`."""

    def __init__(self, root, program, seconds):
        self.root, self.program, self.seconds = root, program, seconds
        self.files = files_of(root)
        self.names = {os.path.basename(name) for name in self.files}
        self.documents = [Document(root, name) for name in self.files if name.endswith(".md")]
        self.cmake = "".join(re.sub(r"#.*", "", read(os.path.join(root, name))) for name in self.files
                             if name.endswith(("CMakeLists.txt", ".cmake")))
        self.helps = {}

    # Links and paths

    def broken_links(self):
        anchors = {document.name: document.anchors() for document in self.documents}
        for document in self.documents:
            for line, target in document.links():
                if re.match(r"[a-z][a-z0-9+.-]*:", target):
                    continue
                path, _, anchor = urllib.parse.unquote(target).partition("#")
                base = "" if path.startswith("/") else document.folder
                name = os.path.normpath(os.path.join(base, path.lstrip("/"))) if path else document.name
                if not os.path.exists(os.path.join(self.root, name)):
                    yield f"{document.name}:{line}: {target}: there is no such file"
                elif anchor and name in anchors and anchor not in anchors[name]:
                    yield f"{document.name}:{line}: {target}: {name} has no such heading"

    def missing_paths(self):
        for document in self.documents:
            for span in document.spans:
                path = span.text
                if not re.fullmatch(r"[\w.*?{},/+-]+", path) or is_placeholder(path):
                    continue
                if "/" not in path:
                    if re.fullmatch(r"[\w-]+\.(h|cpp)", path) and path not in self.names:
                        yield f"{document.name}:{span.line}: {path}: no file of the repository has this name"
                    continue
                first = path.split("/")[0]
                beside = document.folder and os.path.exists(os.path.join(self.root, document.folder, first))
                if first not in TOPS and not beside:
                    continue
                found = self.matches(path, "") or (self.matches(path, document.folder) if beside else [])
                made = path.startswith("results/") or any(
                    self.is_ignored(os.path.join(base, path)) for base in ("", document.folder))
                if not found and not made:
                    yield f"{document.name}:{span.line}: {path}: there is no such file or folder"

    def missing_functions(self):
        """Names that a document looks for in a file, as in `path/path.cpp`: `trace`, `Walk::next`."""
        places = re.compile(r"`([\w./-]+\.(?:h|cpp|js|py))`:((?:,?\s+`[^`]+`)+)")
        for document in self.documents:
            for place in places.finditer(document.marked_prose):
                found = self.matches(place[1], "") or self.matches(place[1], document.folder)
                text = "".join(map(read, found))
                line = 1 + document.marked_prose.count("\n", 0, place.start())
                for name in re.findall(r"`(?:\w+::)*(\w+)(?:\(\))?`", place[2]):
                    if found and not re.search(rf"\b{name}\b", text):
                        yield f"{document.name}:{line}: {place[1]}: the file has no {name}"

    def matches(self, path, folder):
        """The files that a path stands for; none if one of its alternatives {a,b} has none."""
        braces = re.search(r"\{([^{}]*)\}", path)
        if braces:
            parts = [self.matches(path[:braces.start()] + part + path[braces.end():], folder)
                     for part in braces[1].split(",")]
            return sum(parts, []) if all(parts) else []
        whole = os.path.join(self.root, folder, path)
        return glob.glob(whole) or glob.glob(whole + ".h") + glob.glob(whole + ".cpp")

    def is_ignored(self, path):
        """Whether git ignores it, because a script or a build makes it."""
        ignored = os.path.join(self.root, ".gitignore")
        prefixes = [line.lstrip("/") for line in read(ignored).split()] if os.path.exists(ignored) else []
        return any((path.rstrip("/") + "/").startswith(prefix) for prefix in prefixes)

    # Commands that are only looked at

    def help_of(self, *command):
        if command not in self.helps:
            run = subprocess.run([*command, "--help"], capture_output=True, text=True, check=False, timeout=60,
                                 cwd=self.root, stdin=subprocess.DEVNULL)
            self.helps[command] = run.stdout if run.returncode == 0 else None
        return self.helps[command]

    def wrong_in(self, command, folder, is_inline):
        """What is wrong with a command, apart from what only running it can tell; named files are sought in folder."""
        words = words_of(command)
        if words[0] in ("ctest", "cmake"):
            yield from self.wrong_presets(words)
            return
        known = self.known_options(words)
        if known is None:
            yield "there is no such command" if words[0] in PROGRAMS else "there is no such script that can be run"
            return
        previous = ""
        for word in words[1:]:
            option = re.match(r"--?[A-Za-z][\w-]*", word)
            if option and not re.search(rf"(?<![\w-]){option[0]}(?![\w-])", known):
                yield f"it has no option {option[0]}"
            if previous == "--scene" and not is_placeholder(word):
                word = f"scenes/{word}.xml"
            is_file = word.split("/")[0] in TOPS and "/" in word or not is_inline and word.endswith((".toml", ".xml"))
            if is_file and previous not in ("-o", "--out") and not is_placeholder(word):
                if not os.path.exists(os.path.join(folder, word)) and not self.is_ignored(word):
                    yield f"there is no file {word}"
            previous = word

    def known_options(self, words):
        """A text in which all options of the command occur; None if there is no such command."""
        if words[0] in PROGRAMS:
            command = [self.program]
            for word in words[1:]:  # `gibench list methods` has two subcommands
                subcommands = self.help_of(*command).partition("Subcommands:\n")[2]
                if not subcommands or not re.fullmatch(r"[a-z-]*[a-z]", word) or word[0] == "-":
                    break
                if not re.search(rf"^  {word}\b", subcommands, re.MULTILINE):
                    return None
                command.append(word)
            return self.help_of(*command)
        path = os.path.join(self.root, words[0])
        if not os.path.isfile(path) or not os.access(path, os.X_OK):
            return None
        text = read(path)
        if "python" in text.split("\n", maxsplit=1)[0]:
            return self.help_of(path)
        # The other scripts would begin to build; their text has their options.
        if "options of ctest" in text:
            text += self.help_of("ctest")
        if "gibench run" in text:
            text += self.help_of(self.program, "run")
        return text

    def wrong_presets(self, words):
        kind = "testPresets" if words[0] == "ctest" else "buildPresets" if "--build" in words else "configurePresets"
        presets = json.loads(read(os.path.join(self.root, "CMakePresets.json"))).get(kind, [])
        names = [preset["name"] for preset in presets if not preset.get("hidden")]
        for i, word in enumerate(words):
            option = re.match(r"-D(GIB_\w+)", word)
            if option and not re.search(rf"\b{option[1]}\b", self.cmake):
                yield f"no CMakeLists.txt has the option {option[1]}"
            value = word.partition("=")[2] or (words[i + 1] if i + 1 < len(words) else "")
            if is_placeholder(value):
                continue
            if word.split("=")[0] == "--preset" and value not in names:
                yield f"CMakePresets.json has no preset {value!r} among its {kind}"
            if words[0] == "ctest" and word in ("-L", "--label-regex"):
                for label in value.split("|"):
                    if not re.search(rf"\b{re.escape(label)}\b", self.cmake):
                        yield f"no CMakeLists.txt has the label {label!r}"

    def wrong_inline_commands(self, documents=None):
        for document in documents or self.documents:
            for span in document.spans:
                words = words_of(span.text)
                if len(words) > 1 and is_command(span.text) and not words[1].startswith("..."):
                    for why in self.wrong_in(span.text, self.root, is_inline=True):
                        yield f"{document.name}:{span.line}: {span.text}: {why}"

    # Commands that run

    def failing_blocks(self, document):
        with tempfile.TemporaryDirectory() as folder:
            scratch = Scratch(self, folder, document)
            for block in document.blocks:
                if block.language in ("toml", "xml"):
                    problems = scratch.wrong_file(block)
                elif block.language in SHELL:
                    problems = ((line, command, why) for line, command in block.commands() if is_command(command)
                                for why in scratch.wrong_with(command))
                else:
                    continue
                for line, what, why in problems:
                    yield f"{document.name}:{line}: {what}: {why}"

    def unexplained_columns(self, name):
        """The columns of result files that do not stand in backticks in this document. Ends of intervals may be
        explained by `_lo` and `_hi`, columns of one kind for each target by one of them, such as `seconds_to_5pct`."""
        def kind(word):
            return re.sub(r"_to_[\d.]*[A-Z]*pct", "_to_5pct", word)

        document = Document(self.root, name)
        words = {kind(word) for span in document.spans for word in re.findall(r"[\w.]+", span.text)}
        with tempfile.TemporaryDirectory() as folder:
            scratch = Scratch(self, folder, document)
            scratch.make_results("columns")
            for table in ("table.csv", "curves.csv", "spectra.csv", "stages.csv"):
                with open(scratch.path("results/columns/" + table), encoding="utf-8", newline="") as file:
                    columns = next(csv.reader(file))
                for column in columns:
                    end = re.search(r"_(lo|hi)$", column)
                    is_end = end and end[0] in words and kind(column[:-3]) in words
                    if kind(column) not in words and not is_end:
                        yield f"{name}: the column `{column}` of {table} is not explained"


class Scratch:
    """A folder that looks like the top of the repository, with the program built and no results."""

    def __init__(self, checker, folder, document):
        self.checker, self.folder, self.document = checker, folder, document
        for name in os.listdir(checker.root):
            if name not in ("build", "results") and not name.startswith("."):
                self.show(name)
        for program in ("build/release/experiments/gibench", "bin/gibench"):
            os.makedirs(os.path.dirname(self.path(program)))
            os.symlink(checker.program, self.path(program))
        for name in ("results", "home"):
            os.mkdir(self.path(name))
        self.environment = {**os.environ, "PATH": self.path("bin") + ":" + os.environ.get("PATH", ""),
                            "HOME": self.path("home")}

    def path(self, name):
        return os.path.join(self.folder, name)

    def show(self, name):
        """Links a file or folder of the repository. Commands may write new files into scenes/ and experiments/."""
        original = os.path.join(self.checker.root, name)
        if name not in ("scenes", "experiments"):
            os.symlink(original, self.path(name))
            return
        os.mkdir(self.path(name))
        for entry in os.listdir(original):
            os.symlink(os.path.join(original, entry), os.path.join(self.path(name), entry))

    def run(self, command):
        """Returns the exit code (None: stopped after the longest time) and the end of what the command printed."""
        with subprocess.Popen(["bash", "-c", command], cwd=self.folder, env=self.environment, text=True,
                              stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              start_new_session=True) as process:
            try:
                output, _ = process.communicate(timeout=self.checker.seconds)
                return process.returncode, output[-1000:]
            except subprocess.TimeoutExpired:
                os.killpg(process.pid, signal.SIGKILL)
                return None, process.communicate()[0][-1000:]

    def make_results(self, name):
        """Stands in for the results that ./scripts/run would have left: a tiny experiment."""
        if os.path.exists(self.path("results/" + name)):
            return
        commands = [command for block in self.document.blocks for _, command in block.commands()]
        named = {"cornell-box", *re.findall(r"--scene[ =]([\w-]+)", "\n".join(commands))}
        files = [f"scenes/{scene}.xml" for scene in sorted(named)]
        scenes = [f'"{name}"' for name in files if os.path.exists(self.path(name))]
        with open(self.path("tiny.toml"), "w", encoding="utf-8") as file:
            file.write(TINY.format(scenes=", ".join(scenes)))
        code, output = self.run(f"gibench run tiny.toml --out results/{name}")
        if code != 0:
            raise RuntimeError(f"the tiny experiment failed: {output}")

    def wrong_with(self, command):
        """What is wrong with a command of a block. The program and scripts/plot run, others are looked at."""
        words = words_of(command)
        draws = words[0].endswith("scripts/plot")
        if words[0] not in PROGRAMS:
            yield from self.checker.wrong_in(command, self.folder, is_inline=False)
            if not draws:
                return
        if draws or words[1:2] in (["report"], ["compare-runs"]) or "--repeat" in words:
            for name in results_named(command):
                self.make_results(name)
        if draws and not importlib.util.find_spec("matplotlib"):
            return
        code, output = self.run(command)
        expected = exit_codes(command)
        if code is None:
            yield f"takes more than {self.checker.seconds} s; it printed:\n{output}"
        elif code not in expected:
            yield f"exit code {code} instead of {' or '.join(map(str, sorted(expected)))}; it printed:\n{output}"

    def name_of(self, block):
        """The name under which the text has the reader save a block, or one of our own."""
        line = block.lines[0][0] if block.lines else 0
        before = "\n".join(self.document.marked_prose.split("\n")[:line - 1]).rstrip().split("\n\n")[-1]
        first = block.lines[0][1] if block.lines else ""
        ending = r"[\w./-]*\w\." + block.language
        commands = [command for other in self.document.blocks if other.language in SHELL
                    for start, command in other.commands() if start > line]
        names = re.findall(rf"#.*?({ending})", first) + re.findall(ending, before)[::-1] + [
            word for command in commands for word in words_of(command) if re.fullmatch(ending, word)]
        for name in names:
            folder = os.path.realpath(os.path.dirname(self.path(name)))  # links lead into the repository
            is_inside = (folder + "/").startswith(os.path.realpath(self.folder) + "/")
            if is_inside and not os.path.lexists(self.path(name)):
                return name
        return ("experiments/" if '"../scenes/' in block.text() else "") + f"block-{line}.{block.language}"

    def wrong_file(self, block):
        """Saves an experiment or a scene and reads it with the program. A part of an experiment is completed first."""
        text, name = block.text(), self.name_of(block)
        line = block.lines[0][0] if block.lines else 0
        if block.language == "xml" and "<scene" not in text:
            return
        if block.language == "toml":
            if not re.search(r"^scenes\s*=|^\[\[case\]\]", text, re.MULTILINE):
                text = f'scenes = ["{self.path("scenes/cornell-box.xml")}"]\n' + text
            if not re.search(r"^\[\[method\]\]|^\[tune\]", text, re.MULTILINE):
                text += '\n[[method]]\nname = "path"\n'
        os.makedirs(os.path.dirname(self.path(name)), exist_ok=True)
        with open(self.path(name), "w", encoding="utf-8") as file:
            file.write(text)
        if block.language == "xml":
            code, output = self.run(f"gibench plan {shlex.quote(name)}")
            good = code == 0
        else:  # --only is looked at last, when the whole file has been read
            code, output = self.run(f"gibench run {shlex.quote(name)} --only {NOTHING} --out results/none")
            good = code == 2 and f"--only '{NOTHING}' keeps no" in output
        if not good:
            yield line, name, f"is refused:\n{output}"
