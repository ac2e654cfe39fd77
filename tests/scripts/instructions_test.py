"""Tests of scripts/instructions: names and counts of functions in a file of callgrind, and comparisons of known counts."""
import collections
import contextlib
import importlib.machinery
import importlib.util
import io
import os
import unittest

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.realpath(__file__))))
LOADER = importlib.machinery.SourceFileLoader("instructions", os.path.join(ROOT, "scripts", "instructions"))
instructions = importlib.util.module_from_spec(importlib.util.spec_from_loader("instructions", LOADER))
LOADER.exec_module(instructions)

CALLGRIND = """version: 1
cmd:  gibench render
positions: line
events: Ir
summary: 1000

ob=(1) /usr/bin/gibench
fl=(1) ???
fn=(1) gib::trace(gib::Scene const&)
0 40
cfn=(2) float gib::(anonymous namespace)::weigh<float, true>(float)
calls=3 0
0 500
+2 60
ob=(2) /usr/lib/libembree3.so.3
fn=(3) 0x00000000000c0a10
0 300
fn=(2)
0 500
* 100
"""


class Instructions(unittest.TestCase):
    def compared(self, before, now):
        """Whether nothing has grown, and what is printed."""
        kept = {"commit": "c0ffee1234567", "pieces": {"path": {"instructions": sum(before.values()), "functions": before}}}
        out = io.StringIO()
        with contextlib.redirect_stdout(out):
            good = instructions.compare(kept, {"path": collections.Counter(now)})
        return good, out.getvalue()

    def test_own_instructions_leave_out_those_of_called_functions(self):
        self.assertEqual(instructions.functions_in(CALLGRIND.splitlines()),
                         {"gib::trace": 100, "gib::weigh": 600, "libembree3.so.3": 300})

    def test_names_have_no_templates_and_arguments(self):
        for name, short in (
                ("embree::avx2::BVHNIntersector1<4, 1, false>::intersect(embree::Accel const*)", "embree::avx2::BVHNIntersector1::intersect"),
                ("std::ostream& operator<< <char>(std::ostream&, char)", "operator_sign"),
                ("gib::Less::operator()(int, int) const", "gib::Less::operator_call"),
                ("std::_Function_handler<void (int), gib::Path::pass(int)::{lambda(int)#1}>::_M_invoke(int&&) [clone .cold]",
                 "std::_Function_handler::_M_invoke of gib::Path::pass"),
                ("operator new(unsigned long)", "operator_new"), ("main", "main")):
            self.assertEqual(instructions.short_name(name), short)

    def test_a_growth_is_told_with_the_function_that_grew(self):
        good, said = self.compared({"gib::a": 600, "gib::b": 300, "gib::c": 100}, {"gib::a": 610, "gib::b": 370, "gib::new": 150})
        self.assertFalse(good)
        self.assertIn("path takes 13.0 % more instructions than at c0ffee1234; most of it: gib::b +70, gib::new +50, gib::a +10\n", said)

    def test_less_than_five_per_cent_is_no_growth(self):
        self.assertEqual(self.compared({"gib::a": 1000}, {"gib::a": 1049})[0], True)
        self.assertEqual(self.compared({"gib::a": 1000}, {"gib::a": 1051})[0], False)
        good, said = self.compared({"gib::a": 1000}, {"gib::a": 900})
        self.assertTrue(good)
        self.assertIn("--keep", said)


if __name__ == "__main__":
    unittest.main()
