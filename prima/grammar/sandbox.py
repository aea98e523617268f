"""A sandboxed ECMAScript engine for the tags of grammars: time, memory and stack are bounded.

Built-ins that do not look at the time limit are replaced by ones that bound their work. ``Date``
is absent and ``Math.random`` seeded, so that a match can be repeated.
"""

from __future__ import annotations

import json
from time import perf_counter
from typing import Any

import _quickjs as quickjs

from prima.messages import Json

TIME_LIMIT = 0.5
"""Seconds of processor time that the tags of one match may take."""
MEMORY_LIMIT = 16 * 1024 * 1024
STACK_LIMIT = 256 * 1024
RESULT_LIMIT = 100_000
"""Characters that a value may have when it leaves the engine."""

PRELUDE = r"""
(function () {
  'use strict';
  const LONGEST = 1000000, WORK = 100000000;
  const apply = Reflect.apply, isArray = Array.isArray;
  const define = (object, name, value) => Object.defineProperty(
    object, name, { value: value, writable: true, configurable: true, enumerable: false });
  for (const name of ['Date', 'Proxy', 'BigInt', 'ArrayBuffer', 'SharedArrayBuffer', 'DataView',
      'Atomics', 'Uint8Array', 'Int8Array', 'Uint8ClampedArray', 'Int16Array', 'Uint16Array',
      'Int32Array', 'Uint32Array', 'BigInt64Array', 'BigUint64Array', 'Float16Array',
      'Float32Array', 'Float64Array', 'WeakRef', 'FinalizationRegistry', 'performance',
      'queueMicrotask', 'navigator', 'gc', 'std', 'os', 'bjson', 'DOMException'])
    delete globalThis[name];
  for (const name of Object.getOwnPropertyNames(Array.prototype)) {
    const native = Array.prototype[name];
    if (typeof native !== 'function' || name === 'constructor' || name === 'push' || name === 'pop')
      continue;
    define(Array.prototype, name, function (...given) {
      if (!isArray(this)) throw new TypeError(name + ' is for arrays alone');
      if (this.length > LONGEST) throw new RangeError('the array is too long');
      return apply(native, this, given);
    });
  }
  define(Array.prototype, Symbol.iterator, Array.prototype.values);
  define(Array, 'from', function (source, map) {
    const made = [];
    if (source != null && source[Symbol.iterator] !== undefined)
      for (const item of source) made.push(map ? map(item, made.length) : item);
    else {
      const length = source == null ? 0 : Math.min(Number(source.length) || 0, 2 ** 32);
      for (let i = 0; i < length; i++) made.push(map ? map(source[i], i) : source[i]);
    }
    return made;
  });
  for (const name of ['indexOf', 'lastIndexOf', 'includes', 'split', 'replace', 'replaceAll',
      'matchAll', 'match', 'search', 'repeat', 'padStart', 'padEnd', 'localeCompare',
      'normalize', 'isWellFormed', 'toWellFormed']) {
    const native = String.prototype[name];
    if (typeof native !== 'function') continue;
    define(String.prototype, name, function (...given) {
      const own = String(this), first = given.length && typeof given[0] === 'string' ? given[0] : '';
      if (own.length * (first.length + 1) > WORK) throw new RangeError('the text is too long');
      return apply(native, own, given);
    });
  }
  define(String, 'raw', function (strings, ...given) {
    const raw = strings.raw, length = Number(raw.length) || 0;
    if (length > LONGEST) throw new RangeError('the text is too long');
    let made = '';
    for (let i = 0; i < length; i++) made += raw[i] + (i + 1 < length && i < given.length ? given[i] : '');
    return made;
  });
  let seed = 88172645;
  define(Math, 'random', function () {
    seed ^= seed << 13; seed ^= seed >>> 17; seed ^= seed << 5;
    return (seed >>> 0) / 4294967296;
  });
})();
"""

HELPERS = r"""
(function () {
'use strict';
const stringify = JSON.stringify, parse = JSON.parse, isArray = Array.isArray;
const assign = Object.assign, define = Object.defineProperty;
const hidden = (object, name, value) => define(object, name, { value: value, writable: true });
const plain = (value) => value !== null && typeof value === 'object' && !isArray(value);
return {
  box: function (text) { return { v: parse(text) }; },
  json: function (box) { return stringify(box.v); },
  environment: function (text, merges) {
    let last, lastMeta = { text: '', score: 1 }, at = 0;
    const own = { text: text, score: 1 }, rules = {}, meta = {}, waiting = [];
    hidden(rules, 'latest', function () { return last; });
    hidden(meta, 'latest', function () { return lastMeta; });
    hidden(meta, 'current', function () { return own; });
    return {
      rules: rules, meta: meta,
      add: function (name, box, text) { waiting.push([name, box, { text: text, score: 1 }]); },
      next: function (out) {
        const [name, box, about] = waiting[at++];
        last = box.v; lastMeta = about;
        if (name !== 'latest') rules[name] = last;
        if (name !== 'latest' && name !== 'current') meta[name] = about;
        if (merges && plain(out) && plain(last)) assign(out, last);
      },
    };
  },
}; })()
"""


class ScriptError(Exception):
    """A tag's script failed."""


class Sandbox:
    """The ECMAScript of one grammar document while one utterance is interpreted."""

    def __init__(self) -> None:
        context = quickjs.Context()
        context.set_memory_limit(MEMORY_LIMIT)
        context.set_max_stack_size(STACK_LIMIT)
        context.set_time_limit(TIME_LIMIT)
        context.eval(PRELUDE)
        self._context = context
        self._helpers = context.eval(HELPERS)
        self._functions: dict[str, Any] = {}
        self._spent = 0.0

    def _call(self, function: Any, *given: Any) -> Any:
        if self._spent > TIME_LIMIT:
            raise ScriptError(f"the tags took longer than {TIME_LIMIT:g} s")
        began = perf_counter()
        try:
            return function(*given)
        except (quickjs.JSException, quickjs.StackOverflow) as error:
            raise ScriptError(_said(str(error))) from None
        except (TypeError, ValueError, OverflowError, MemoryError) as error:
            raise ScriptError(f"it gives what cannot be used: {error}") from None
        finally:
            self._spent += perf_counter() - began

    def run(self, code: str) -> None:
        """Run a script in the global scope (SISR 1.0: global tags)."""
        self._call(self._context.eval, f"{code}\n;0")

    def box(self, value: Json) -> Any:
        """A value from outside, as functions of the sandbox take it."""
        return self._call(self._helper("box"), json.dumps(value))

    def environment(self, text: str, merges: bool) -> Any:
        """What a rule's tags see; rules that it refers to are added in order."""
        return self._call(self._helper("environment"), text, merges)

    def add(self, environment: Any, name: str, box: Any, text: str) -> None:
        """Add the value of a rule that was referred to."""
        self._call(self._member(environment, "add"), name, box, text)

    def rule(self, code: str, environment: Any) -> Any:
        """Run the tags of a rule; ``$next(out)`` in them passes a rule that was referred to."""
        function = self._functions.get(code)
        if function is None:
            body = f"(function (rules, meta, $next, out) {{\n{code}\nreturn {{ v: out }};\n}})"
            function = self._functions[code] = self._call(self._context.eval, body)
        given = [self._member(environment, name) for name in ("rules", "meta", "next")]
        return self._call(function, *given, self._call(self._context.eval, "({})"))

    def checks(self, code: str) -> bool:
        """Whether a script is well-formed by itself."""
        try:
            self._context.eval(f"(void new Function({json.dumps(code)}))")
        except (quickjs.JSException, quickjs.StackOverflow):
            return False
        return True

    def json(self, box: Any) -> Json:
        """A boxed value as plain data; undefined and functions become None."""
        text = self._call(self._helper("json"), box)
        if not isinstance(text, str):
            return None
        if len(text) > RESULT_LIMIT:
            raise ScriptError(f"it gives more than {RESULT_LIMIT:,} characters")
        return json.loads(text)

    def _helper(self, name: str) -> Any:
        return self._member(self._helpers, name)

    def _member(self, thing: Any, name: str) -> Any:
        getter = self._functions.get(f".{name}")
        if getter is None:
            getter = self._functions[f".{name}"] = self._context.eval(f"((o) => o.{name})")
        return self._call(getter, thing)


def _said(text: str) -> str:
    """The engine's message, in words."""
    message = (text.splitlines() or [""])[0]
    if message.startswith("InternalError: interrupted"):
        return f"it took longer than {TIME_LIMIT:g} s"
    if message == "null" or "out of memory" in message or not message:
        return "it used too much memory"
    return message
