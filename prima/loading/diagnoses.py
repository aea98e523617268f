"""Diagnoses of the files that documents name, and of how scenarios use them."""

from __future__ import annotations

from prima.errors.diagnoses.names import NO_SUCH_FILE, NO_SUCH_NAME
from prima.errors.diagnoses.structure import MISSING_ATTRIBUTE, OTHER_KIND, UNKNOWN_ATTRIBUTE
from prima.errors.diagnoses.values import BAD_VALUE

NO_FILE_HERE = NO_SUCH_FILE.says(
    'There is no file "{file}" here: this will be error.badfetch.', severity="warning"
)
NOT_FETCHED = NO_SUCH_FILE.says(
    '"{scheme}:" is not fetched: this will be error.badfetch.',
    "Write http:, https: or service:, or the name of a file in the folder.",
    "warning",
)
TOO_LARGE_HERE = NO_SUCH_FILE.says(
    '"{file}" has {size} bytes; at most {most} are read: this will be error.badfetch.',
    "Divide it, or raise the limit: --limit bytes={size}.",
    "warning",
)
OUTSIDE = NO_SUCH_FILE.says(
    '"{file}" is outside of the folder of the first document: this will be error.badfetch.',
    'Let a folder above both represent a URI: "--map https://example.org/=FOLDER", or uri and'
    " folder of the scenario's <application>.",
    "warning",
)
UNREADABLE = NO_SUCH_FILE.says('"{name}" {wrong}')
NOT_SERVED = UNKNOWN_ATTRIBUTE.says(
    '"{src}" is not VoiceXML, which alone is served at a URI.', "Remove uri and folder."
)
OWN_ID = UNKNOWN_ATTRIBUTE.says(
    '"{src}" has the id "{own}": another is for VoiceXML documents.', "Remove it.", "warning"
)
NEEDS_URI = MISSING_ATTRIBUTE.says('A folder is served at a "uri".', "Add it.")
BAD_SITE = BAD_VALUE.says("{wrong}")
NO_AREA = NO_SUCH_NAME.says('The world "{world}" has no <area> that offers an application.')
BAD_POLICY = BAD_VALUE.says("{wrong}")
NO_FAVOURITE = NO_SUCH_NAME.says("{wrong}")
RUNS_AS_OTHER = OTHER_KIND.says("{name} says that it is an {own}, but {who}: it runs as an {kind}.")
