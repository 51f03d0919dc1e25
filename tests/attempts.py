"""The beginning of a script that tries what is refused, and notes in `found` what came of it."""

ATTEMPT = """\
found = {}
def attempt(name, work):
    try:
        work()
        found[name] = "done"
    except Exception as error:
        found[name] = type(error).__name__

"""
