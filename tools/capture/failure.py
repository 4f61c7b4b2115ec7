"""What ends the program with one line."""


class Failure(Exception):
    """Something could not be done: exit code 1."""


class WrongUsage(Exception):
    """What the user asked for makes no sense: exit code 2."""


class MissingPackages(Exception):
    """Debian packages are not installed: exit code 3."""
