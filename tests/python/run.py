# SPDX-License-Identifier: Apache-2.0
"""Runs test files of this folder by pytest; skipped, and said, where it is not installed."""
import os
import sys

if "-fsanitize" in os.environ.get("SUBVOL_FLAGS", "") and "LD_PRELOAD" not in os.environ:
    print("skipped: the interpreter needs the sanitizer's library in LD_PRELOAD (CONTRIBUTING.md)")
    sys.exit(77)
try:
    import pytest
except ImportError:
    print("skipped: python3-pytest is not installed")
    sys.exit(77)
here = os.path.dirname(os.path.abspath(__file__))
sys.exit(pytest.main(["-q", "-rs", "-p", "no:cacheprovider", "--rootdir", here, *(os.path.join(here, name) for name in sys.argv[1:])]))
