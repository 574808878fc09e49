"""All lines of docs/python.md, with what they print."""
import doctest
import os
import shutil
import tempfile
import unittest

import support
from support import ROOT


class Docs(unittest.TestCase):
    def test_python_md(self):
        with tempfile.TemporaryDirectory() as folder:
            shutil.copy(ROOT / "demo" / "knot.ply", folder)
            before = os.getcwd()
            os.chdir(folder)
            try:
                failed, tried = doctest.testfile(str(ROOT / "docs" / "python.md"), module_relative=False, encoding="utf-8")
            finally:
                os.chdir(before)
        self.assertGreater(tried, 40)
        self.assertEqual(failed, 0)


if __name__ == "__main__":
    support.main()
