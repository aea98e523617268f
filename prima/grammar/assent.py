"""Words of assent and of refusal."""

from __future__ import annotations

import re
from functools import lru_cache

from prima.grammar.text import fold

YES = {  # by language; without one, all count
    "en": "yes|yeah|yep|yup|yes i do|yes you may|yes it is|yes sir|yes maam|yes thats right|sure"
    "|of course|ok|okay|correct|right|thats right|thats correct|that is right|that is correct"
    "|true|affirmative|absolutely|definitely|certainly|uh huh|i do|it is",
    "ja": "はい|ええ|うん|そうです|はいそうです|お願いします|もちろん|いいよ|いいですよ|オーケー",
    "fr": "oui|ouais|volontiers|avec plaisir|daccord|bien sûr",
    "de": "ja|ja gern|ja gerne|gern|gerne|jawohl|klar|ja klar|genau|natürlich|richtig|stimmt",
    "es": "sí|si|claro|por supuesto",
    "it": "sì|si|certo|volentieri",
}
NO = {
    "en": "no|nope|nah|no i dont|no i do not|no it isnt|no it is not|no sir"
    "|no maam|not now|wrong|incorrect|thats wrong|thats not right|false|negative|no way|not really"
    "|of course not|i dont|it isnt|never",
    "ja": "いいえ|いえ|いや|ううん|違います|いいえ違います|結構です|いいえ結構です|だめ|ダメ|嫌",
    "fr": "non",
    "de": "nein|nee|falsch",
    "es": "no",
    "it": "no",
}


def assent(said: str, lang: str) -> bool | None:
    """Whether a folded utterance is one or more answers of the same sense, as in "Yes, of course".

    Args:
        said: the folded utterance.
        lang: the language of the answers, as two letters, beside English; if empty, all count.

    Returns:
        True for assent, False for refusal, None for anything else.
    """
    return next((value for value in (True, False) if _repeats(_answer(value, lang), said)), None)


def _repeats(answer: re.Pattern[str], said: str) -> bool:
    at = 0
    while found := answer.match(said, at):
        at = found.end()
        if at == len(said):
            return True
        if said[at] == " ":
            at += 1
        elif said[at - 1].isascii():
            return False
    return False


@lru_cache(32)
def _answer(value: bool, lang: str) -> re.Pattern[str]:
    """A folded answer of one sense; the longest is taken first."""
    words = YES if value else NO
    spoken = [words["en"], words.get(lang, "")] if lang else words.values()
    folded = {fold(one) for one in "|".join(spoken).split("|")} - {""}
    return re.compile("|".join(map(re.escape, sorted(folded, key=len, reverse=True))))
