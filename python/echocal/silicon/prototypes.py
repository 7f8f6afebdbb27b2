"""What the Arduino IDE adds to a sketch: a declaration of each function before the first of them."""

import re

__all__ = ["with_prototypes"]

_DEFINED = re.compile(r"(?P<head>[A-Za-z_][\w:<>,*&\s]*?[\s*&]+(?P<name>\w+)\s*\([^(){};]*\))\s*\{")
_NO_CODE = re.compile(
    r"//(?:\\\n|[^\n])*|/\*.*?(?:\*/|\Z)|\"(?:\\.|[^\"\\\n])*\"|'(?:\\.|[^'\\\n])*'|^[ \t]*\#(?:\\\n|[^\n])*",
    re.DOTALL | re.MULTILINE,
)
_NO_TYPE = re.compile(r"\b(?:template|return|else|operator|class|namespace|typedef)\b")


def with_prototypes(text: str, path: str) -> str:
    r"""Return the sketch as C++: functions may be called above their definition.

    Only these are declared. Functions with default arguments, templates and members of classes are not.
    Messages of the compiler name the sketch's own file and lines.

    Parameters
    ----------
    text : str
        The sketch.
    path : str
        Its file, for messages.

    Examples
    --------
    >>> print(with_prototypes("void loop() { wink(); }\nvoid wink() { }\n", "a.ino"))
    #include <Arduino.h>
    #line 1 "a.ino"
    void wink();
    #line 1 "a.ino"
    void loop() { wink(); }
    void wink() { }
    <BLANKLINE>
    """
    code = _NO_CODE.sub(lambda match: re.sub(r"[^\n]", " ", match[0]), text)
    defined = [match for match in _DEFINED.finditer(_outermost(code)) if _declarable(match["head"])]
    found = [match for match in defined if _is_called(match["name"], code[: match.start()])]
    quoted = path.replace("\\", "\\\\").replace('"', '\\"')
    start = f'#include <Arduino.h>\n#line 1 "{quoted}"\n'
    if not found:
        return start + text
    place = text.rfind("\n", 0, defined[0].start("head")) + 1
    declared = "".join(f"{' '.join(match['head'].split())};\n" for match in found)
    number = text.count("\n", 0, place) + 1
    return f'{start}{text[:place]}{declared}#line {number} "{quoted}"\n{text[place:]}'


def _is_called(name: str, above: str) -> bool:
    return re.search(rf"\b{name}\s*\(", above) is not None


def _declarable(head: str) -> bool:
    return "=" not in head and "::" not in head.split("(")[0] and not _NO_TYPE.search(head)


def _outermost(code: str) -> str:
    """Return the code with blanks for all that is within braces; the braces stay."""
    depth, kept = 0, []
    for sign in code:
        depth -= sign == "}"
        kept.append(sign if depth <= 0 or sign == "\n" else " ")
        depth += sign == "{"
    return "".join(kept)
