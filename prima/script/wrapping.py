"""Our code around and beside the code of documents."""

from __future__ import annotations

import json
import re
from typing import Any

from prima.script.evaluation import ScriptError
from prima.script.globals import GLOBALS, STRANGE, WORD
from prima.script.hoisting import HIDDEN, Hoisted
from prima.script.names import expression_names, script_names
from prima.script.sandbox import DECLARE, GUARD, NAME, REFUSE, SAFE
from prima.script.syntax import FAILURES, script_error

INTO, TARGET = f"into{STRANGE}", f"name{STRANGE}"
"""The scope in which code declares variables, and the variable's name, for our code around it."""
EVALUATING = re.compile(r"eval|\\u")
"""Code that may evaluate other code in its scope."""


class Helpers(dict[str, Any]):
    """Our functions in an engine by their names, each fetched when it is first needed."""

    def __init__(self, context: Any, code: str) -> None:
        super().__init__()
        self._all = context.eval(code)
        self._guarded = context.eval(f"(all, name) => {GUARD}(all[name])")

    def __missing__(self, name: str) -> Any:
        try:
            found = self[name] = self._guarded(self._all, name)
        except FAILURES as error:  # as where the engine's memory is full
            raise script_error(error) from None
        return found


def guarded(parameters: str, body: str) -> str:
    """The code of a function; exceptions of code in it become our errors."""
    if EVALUATING.search(body):  # it might declare anything, even in our function
        return f"{GUARD}(({parameters})=>{{{body}}})"
    caught = f"catch({STRANGE}){{throw {SAFE}({STRANGE})}}"
    return f"(({parameters})=>{{try{{{body}}}{caught}}})"


def _short(scope: str) -> str:
    """The name of a scope's parameter; the first two letters distinguish scopes."""
    return f"{scope[0:2]}{STRANGE}"


def head(scopes: tuple[str, ...]) -> tuple[str, str]:
    """The parameters of a function of scopes, and the code that makes their variables visible."""
    names = [_short(name) for name in scopes]
    return ",".join(names), "".join(f"with({name})" for name in names)


ASSIGNING = re.compile("(?<![=!<>])=(?![=>])")
"""What code has that assigns a variable."""


def refusing(code: str) -> str:
    """What stands around all scopes of an expression that assigns variables: where nobody declares
    one, that is an error, as the engine would forget its value."""
    if ASSIGNING.search(code) is None:
        return ""
    names = sorted(expression_names(code).written - GLOBALS)
    return f"with({REFUSE}({json.dumps(names)}))" if names else ""


PLACE = re.compile(rf"""{WORD}(?:\.{WORD}|\[(?:[\w$.+-]+|"[^"\\\]]*"|'[^'\\\]]*')\])*""")
"""A variable, or a part of its value."""


def check_variable(name: str) -> None:
    """Refuse a text that names neither a variable nor a part of its value.

    Raises:
        ScriptError: it does not.
    """
    if PLACE.fullmatch(name) is None:
        raise ScriptError(f'"{name[:80]}" names no variable')


def assignment(name: str, code: str, scopes: tuple[str, ...]) -> str:
    """The body of an assignment that fails if the variable is undeclared."""
    check_variable(name)
    scope, dot, rest = name.partition(".")
    where = [_short(scope) for scope in reversed(scopes)]
    target = local = name
    if dot and scope in scopes:
        where, local, target = [_short(scope)], rest, f"{_short(scope)}.{rest}"
    head = re.split(r"[.\[]", local, maxsplit=1)[0]
    declared = " || ".join(f"{json.dumps(head)} in {scope}" for scope in where)
    missing = json.dumps(f'the variable "{head}" is not declared')
    return f"if (!({declared})) throw new ReferenceError({missing}); {target} = (\n{code}\n)"


def wrapped(script: Hoisted, scopes: tuple[str, ...]) -> tuple[str, str]:
    """The parameters and body of a script's function: of all scopes, and of that which it declares in."""
    # ECMAScript makes what is assigned and nowhere declared a variable of the outermost
    # scope, which here is the script's own (VoiceXML 5.3.12).
    loose = sorted(script_names(script.code).written - {*script.variables} - GLOBALS)
    known = "||".join(f"n in {_short(scope)}" for scope in scopes)
    declare = (
        f"for(const n of {json.dumps(script.variables)})if(!(n in {INTO})){DECLARE}({INTO},n);"
        f"for(const n of {json.dumps(loose)})"
        f"if(!({known}||n in globalThis)){INTO}[n]=undefined;"
    )
    give = "".join(f"{INTO}.{name}={NAME}({name}{HIDDEN},'{name}');" for name in script.functions)
    export = "".join(
        f"if(typeof {name}!=='undefined'){DECLARE}({INTO},'{name}',{name});"
        for name in script.others
    )
    inner = (
        f"(function(){{{give}\n{script.code}\n;{export}}}).call({INTO})"  # also this is the scope
    )
    names, withs = head(scopes)
    return f"{names},{INTO}", f"{declare}{withs}{{{inner}}}"
