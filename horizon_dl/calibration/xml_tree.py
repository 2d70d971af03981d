"""OpenCV's FileStorage as XML, read without entities or document types."""

import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

from defusedxml.common import DefusedXmlException
from defusedxml.ElementTree import ParseError, fromstring

from horizon_dl.calibration.limits import MAX_DEPTH
from horizon_dl.errors import InputError

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element


def xml_tree(path: Path, text: str) -> Any:
    """Elements as fields, elements called `_` as lists, text as numbers where it is numbers.

    Raises:
        InputError: not XML, or with entities or a document type.
    """
    try:
        # The text is decoded: what its first line says of its bytes does not hold any more.
        root = fromstring(re.sub(r"\A\s*<\?xml[^>]*\?>", "", text).encode(), forbid_dtd=True)
    except ParseError as error:
        place = f" (line {error.position[0]})" if getattr(error, "position", None) else ""
        raise InputError(path, f"is not valid XML{place}", "correct the file") from None
    except (DefusedXmlException, ValueError, LookupError) as error:
        problem = f"has XML that camera files have no use for ({type(error).__name__})"
        raise InputError(path, problem, "take document types and entities out") from None
    if root.tag != "opencv_storage":
        raise InputError(
            path,
            f"is XML with the root <{root.tag[:40]}>, which is not known",
            "give OpenCV's <opencv_storage>, or a camera.yaml",
        )
    return _value(path, root, 0)


def _value(path: Path, element: "Element", depth: int) -> Any:
    if depth > MAX_DEPTH:
        raise InputError(path, f"has over {MAX_DEPTH} levels, as no camera file has", "correct the file")
    children = list(element)
    if children and all(child.tag == "_" for child in children):
        return [_value(path, child, depth + 1) for child in children]
    if children:
        return {child.tag: _value(path, child, depth + 1) for child in children}
    words = (element.text or "").split()
    if element.get("type_id") == "string" or not words:
        return " ".join(words).strip('"')
    try:
        numbers = [float(word) for word in words]
    except ValueError:
        return " ".join(words).strip('"')
    return numbers if len(numbers) > 1 else numbers[0]
