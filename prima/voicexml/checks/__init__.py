"""Checks of VoiceXML documents against the Recommendation's schema and rules."""

from prima.voicexml.checks.failing import check_failing
from prima.voicexml.checks.guests import check_commands
from prima.voicexml.checks.later import check_code, grammar_problems, is_code
from prima.voicexml.checks.names import NAMING
from prima.voicexml.checks.tree import check_tree

__all__ = [
    "NAMING", "check_code", "check_commands", "check_failing", "check_tree", "grammar_problems", "is_code",
]  # fmt: skip
