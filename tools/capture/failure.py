"""What ends the program with one line."""


class Failure(Exception):
    """Something could not be done."""
    exit_code = 1


class WrongUsage(Failure):
    """What the user asked for makes no sense."""
    exit_code = 2


class MissingPackages(Failure):
    """Debian packages are not installed."""
    exit_code = 3
