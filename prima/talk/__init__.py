"""Playing the user of a run: an author types what the user says and does (docs/talk.md)."""

from prima.talk.conversation import Conversation, Screen
from prima.talk.game import Game

__all__ = ["Conversation", "Game", "Screen"]
