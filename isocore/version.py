"""The version, in a file that imports nothing, so that whoever needs it reads no package."""

__version__ = "0.1.0"
