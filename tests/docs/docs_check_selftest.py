# SPDX-License-Identifier: MIT
"""Proves that docs_check.py can fail: one page with one mistake at a time."""
import os
import subprocess
import sys
import tempfile
import unittest

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
GOOD = {
    'docs/a.md': '# A\n\n## Two words: `x`\n\n[b](b.md) [here](#two-words-x) [there](b.md#c) `src/f.cpp` `src/`\n',
    'docs/b.md': '# B\n\n## C\n\n```\n[not a link](nowhere.md)\n```\n',
    'src/f.cpp': 'int name;\n',
    'tests/test_f.cpp': 'TEST_CASE("what it proves, at length") {}\n',
    'docs/notation.md': '# N\n\n| `name` | `src/f.cpp` | `tests/test_f.cpp` "what it proves" |\n',
    'docs/recipes.md': '# R\n\n[One](../examples/one.cpp):\n\n```cpp\n// One.\nint main() {}\n```\n',
    'examples/one.cpp': '// SPDX\n// One.\nint main() {}\n',
}


def check(changes, *options):
    with tempfile.TemporaryDirectory() as root:
        for name, text in {**GOOD, **changes}.items():
            path = os.path.join(root, name)
            os.makedirs(os.path.dirname(path), exist_ok=True)
            with open(path, 'w', encoding='utf-8') as file:
                file.write(text)
        command = [sys.executable, '-B', os.path.join(ROOT, 'scripts', 'docs_check.py'), *options, root]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if options:
            done = subprocess.run([c for c in command if c not in options], capture_output=True, text=True, check=False)
        return done.returncode, done.stderr


class Selftest(unittest.TestCase):
    def wrong(self, changes, message):
        code, errors = check(changes)
        self.assertEqual(code, 1, errors)
        self.assertIn(message, errors)
        self.assertEqual(errors.count('\n'), 1, errors)

    def test_good_pages_pass(self):
        self.assertEqual(check({})[0], 0)

    def test_each_mistake_is_named(self):
        self.wrong({'docs/b.md': '# B\n\n## C\n\n[x](nowhere.md)\n'}, 'docs/b.md:5: dead link nowhere.md')
        self.wrong({'docs/b.md': '# B\n\n## D\n'}, 'no heading for the anchor of b.md#c')
        self.wrong({'docs/b.md': '# B\n\n## C\n\n`src/gone.cpp`\n'}, 'there is no src/gone.cpp')
        self.wrong({'src/f.cpp': 'int other;\n'}, 'name is in none of the files')
        self.wrong({'tests/test_f.cpp': 'TEST_CASE("else") {}\n'}, 'no test of its row is called')
        self.wrong({'examples/one.cpp': '// SPDX\n// Two.\nint main() {}\n'}, 'this is not examples/one.cpp')
        self.wrong({'examples/two.cpp': '// SPDX\nint main() {}\n'}, 'examples/two.cpp is not shown')

    def test_update_copies_the_program(self):
        self.assertEqual(check({'examples/one.cpp': '// SPDX\n// Two.\nint main() {}\n'}, '--update')[0], 0)


if __name__ == '__main__':
    unittest.main()
