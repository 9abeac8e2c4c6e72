"""The exception of the package."""


class Error(Exception):
    """What went wrong: what, where and what to do, in one line. `code` is the kind: invalid_input, not_found,
    unsupported, limit, mismatch or runtime."""

    code = "runtime"
