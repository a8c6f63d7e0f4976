"""What the package's tests share."""

from __future__ import annotations

import os
import tempfile
import unittest

import cairn


class FolderCase(unittest.TestCase):
    """In a folder of its own with a log of two robots, log.h5."""

    @classmethod
    def setUpClass(cls) -> None:
        cls.before = os.getcwd()
        cls.folder = tempfile.TemporaryDirectory()
        os.chdir(cls.folder.name)
        cairn.command("simulate", "loop", "--difficulty", "paper", "--robots", "2", "--seed", "7", "log.h5")

    @classmethod
    def tearDownClass(cls) -> None:
        os.chdir(cls.before)
        cls.folder.cleanup()
