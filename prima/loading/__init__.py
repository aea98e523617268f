"""Loading: reads and checks files together with those that they name.

Only this package and :mod:`prima.api` open documents; everything below works on text and values.
Modules that not every use needs are imported where they are used: most commands are short.
"""

from __future__ import annotations

from prima.loading.applications import load, load_services, read_application
from prima.loading.folders import documents_folder, schemas_folder
from prima.loading.kinds import is_application, is_foreign, is_grammar, is_voicexml
from prima.loading.reading import favourite_problem
from prima.loading.scenarios import (
    Loaded,
    load_scenario,
    load_text,
    seeded,
    with_robot,
    with_scenario,
)
from prima.loading.stages import stage
from prima.loading.validation import Validation, once, upper_first, validate
from prima.loading.voicedocuments import mappings

__all__ = [
    "Loaded", "Validation", "documents_folder", "favourite_problem", "is_application",
    "is_foreign", "is_grammar", "is_voicexml", "load", "load_scenario", "load_services",
    "load_text", "mappings", "once", "read_application", "schemas_folder", "seeded", "stage",
    "upper_first", "validate", "with_robot", "with_scenario",
]  # fmt: skip
