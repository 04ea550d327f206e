"""The commands ``reproduce``, ``study`` and ``challenge``."""
