"""What is refused."""


class Error(ValueError):
    """What pt326 refuses, with the text that the command line has for it."""


Error.__module__ = "pt326"
