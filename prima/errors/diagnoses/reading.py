"""Files that cannot be read as XML."""

from __future__ import annotations

from prima.errors.diagnosis import Diagnosis

NOT_XML = Diagnosis(
    "not-xml",
    "Not well-formed XML",
    (
        "The file is not well-formed XML: a tag is not closed, a quote is missing, or it is "
        "not XML at all. The place is where reading stopped; the mistake is there or before."
    ),
    rule="XML 1.0, 2.1",
)

ENCODING = Diagnosis(
    "encoding",
    "Unknown or wrong encoding",
    (
        "Documents are read as UTF-8, UTF-16, ASCII, ISO-8859, Windows-125x, KOI8, Shift_JIS, "
        "EUC-JP, ISO-2022-JP, GB 2312, GBK, GB 18030, Big5 or EUC-KR. Save the file as UTF-8, "
        "which needs no declaration. A file in UTF-8 that declares an encoding of one byte a "
        "letter is read as that, with a warning."
    ),
    rule="XML 1.0, 4.3.3",
)

TOO_LARGE = Diagnosis(
    "too-large",
    "File too large",
    (
        "Files are read up to a limit on bytes, elements and attributes, so that no file can "
        "exhaust the machine."
    ),
)

TOO_DEEP = Diagnosis(
    "too-deep",
    "Elements nested too deep",
    "Elements may be nested up to a limit. Divide the document into smaller parts.",
)

DOCTYPE = Diagnosis(
    "doctype",
    "DOCTYPE that declares something",
    (
        "A DOCTYPE may name an external identifier, which is never fetched, but declare "
        "nothing itself: declarations can make XML eat memory."
    ),
    rule="XML 1.0, 2.8",
)

ENTITY = Diagnosis(
    "entity",
    "Unknown entity",
    (
        "Documents declare no entities. Only &amp; &lt; &gt; &quot; &apos; and character "
        "numbers are known."
    ),
    rule="XML 1.0, 4.1",
)
