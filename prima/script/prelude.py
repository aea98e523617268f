"""What ECMAScript of strangers starts with: what makes a run repeatable.

``Math.random`` is seeded and no clock of the host can be read: ``Date`` is :data:`DATE`, whose clock
is the run's. What waits, or tells when memory was collected, is not there.
"""

from __future__ import annotations

MEMORY_LIMIT = 16 * 1024 * 1024
"""Bytes that one engine may use."""
STACK_LIMIT = 256 * 1024

PRELUDE = r"""
(function () {
  'use strict';
  const define = (object, name, value) => Object.defineProperty(
    object, name, { value: value, writable: true, configurable: true, enumerable: false });
  for (const name of ['Date', 'Proxy', 'BigInt', 'ArrayBuffer', 'SharedArrayBuffer', 'DataView',
      'Atomics', 'Uint8Array', 'Int8Array', 'Uint8ClampedArray', 'Int16Array', 'Uint16Array',
      'Int32Array', 'Uint32Array', 'BigInt64Array', 'BigUint64Array', 'Float16Array',
      'Float32Array', 'Float64Array', 'WeakRef', 'FinalizationRegistry', 'performance',
      'queueMicrotask', 'navigator', 'gc', 'std', 'os', 'bjson', 'DOMException'])
    delete globalThis[name];
  let seed = 88172645;
  define(Math, 'random', function () {
    seed ^= seed << 13; seed ^= seed >>> 17; seed ^= seed << 5;
    return (seed >>> 0) / 4294967296;
  });
})();
"""

SAFE, GUARD, EVALUATE = "\u01c0safe", "\u01c0guard", "\u01c0evaluate"
GIVE = "\u01c0give"
NAME = "\u01c0name"
"""What :data:`GUARDS` makes, by names that hardly any document has."""

GUARDS = r"""
(function () {
  'use strict';
  const text = String, Err = Error, define = Object.defineProperty, apply = Reflect.apply;
  const slice = String.prototype.slice, wellFormed = String.prototype.toWellFormed;
  const evaluate = eval;
  const short = (said, most) => apply(wellFormed, apply(slice, said, [0, most]), []);
  // The binding turns what was thrown into text when its limits do not hold any more. So it gets
  // an error of ours instead, in which nobody's code is left; errors of the engine itself, which
  // cannot be caught, are told by prototypes that nobody can change.
  const safe = (thrown) => {
    let said = '(Failed obtaining)', stack = '';
    try { said = text(thrown); } catch (_) { }
    try { stack = thrown.stack; } catch (_) { }
    const made = new Err(short(said, 2000));
    define(made, 'name', { value: '' });
    define(made, 'stack', { value: typeof stack === 'string' ? short(stack, 20000) : '' });
    return made;
  };
  const guards = [
    (f) => function () { try { return f(); } catch (e) { throw safe(e); } },
    (f) => function (a) { try { return f(a); } catch (e) { throw safe(e); } },
    (f) => function (a, b) { try { return f(a, b); } catch (e) { throw safe(e); } },
    (f) => function (a, b, c) { try { return f(a, b, c); } catch (e) { throw safe(e); } },
    (f) => function (a, b, c, d) { try { return f(a, b, c, d); } catch (e) { throw safe(e); } },
  ];
  const any = (f) => function (...all) {
    try { return apply(f, undefined, all); } catch (e) { throw safe(e); }
  };
  // The binding cannot give out a text that is joined lazily, which slice joins, or that has half a
  // surrogate pair, and cuts one at its first NUL: such a text is given as an object.
  const indexOf = String.prototype.indexOf, box = Object;
  const give = (said) => {
    const whole = short(said, said.length);
    return apply(indexOf, whole, ['\0']) < 0 ? whole : box(whole);
  };
  const given = {
    '\u01c0give': give,
    '\u01c0safe': safe,
    '\u01c0guard': (f) => (guards[f.length] || any)(f),
    '\u01c0evaluate': guards[1]((code) => { evaluate(code); }),
    '\u01c0name': (f, name) => define(f, 'name', { value: name, configurable: true }),
  };
  for (const name of Object.keys(given)) define(globalThis, name, { value: given[name] });
  const { get: getStack, set: setStack } = Object.getOwnPropertyDescriptor(Err.prototype, 'stack');
  const still = (value) => () => value, none = still(undefined), message = still('');
  const prototypes = [], toString = still(Err.prototype.toString);
  const setter = (key) => function (own) {  // what inherits from a prototype may have its own
    for (let i = 0; i < prototypes.length; i++) if (prototypes[i] === this) return;
    define(this, key, { value: own, writable: true, configurable: true, enumerable: true });
  };
  const setters = {};
  for (const key of ['name', 'message', 'toString']) setters[key] = setter(key);
  const setPrimitive = setter(Symbol.toPrimitive);
  const lock = (prototype, key, get, set) =>
    define(prototype, key, { get: get, set: set, enumerable: false, configurable: false });
  for (const kind of ['Error', 'EvalError', 'RangeError', 'ReferenceError', 'SyntaxError',
      'TypeError', 'URIError', 'InternalError', 'AggregateError', 'SuppressedError']) {
    if (typeof globalThis[kind] !== 'function') continue;
    const prototype = prototypes[prototypes.length] = globalThis[kind].prototype;
    lock(prototype, 'name', still(kind), setters.name);
    lock(prototype, 'message', message, setters.message);
    lock(prototype, 'toString', toString, setters.toString);
    lock(prototype, Symbol.toPrimitive, none, setPrimitive);
    lock(prototype, 'stack', getStack, setStack);
  }
  for (const key of ['prepareStackTrace', 'stackTraceLimit']) {
    lock(Err, key, still(Err[key]), none);
  }
})();
"""


def reason(text: str, seconds: float) -> str:
    """Why a script failed, in words, by what the engine says; ``seconds`` is its limit."""
    message = (text.splitlines() or [""])[0]
    if message.startswith("InternalError: interrupted"):
        return f"it took longer than {seconds:g} s"
    if message == "null":  # all that the engine says where no memory is left for an error
        return "it threw null, or used too much memory"
    if "out of memory" in message or message == "" or "string too long" in message:
        return "it used too much memory"
    if message.startswith("(Failed obtaining"):
        return "it threw a value that cannot be shown"
    if message == "[object Object]":
        return "it threw an object that is no Error"
    return message


START = "2005-03-01T10:00:00"
"""When a run begins by its own calendar, if nobody says (UTC)."""

DATE = r"""
(function (Native, clock) {
  'use strict';
  const own = Native.prototype, UTC = Native.UTC;
  const apply = Reflect.apply, make = Reflect.construct, getTime = own.getTime;
  const setDay = own.setUTCFullYear, setHours = own.setUTCHours;
  const DAYS = ['Sun', 'Mon', 'Tue', 'Wed', 'Thu', 'Fri', 'Sat'];
  const MONTHS = ['Jan', 'Feb', 'Mar', 'Apr', 'May', 'Jun', 'Jul', 'Aug', 'Sep', 'Oct', 'Nov', 'Dec'];
  const ZONES = { EST: -5, EDT: -4, CST: -6, CDT: -5, MST: -7, MDT: -6, PST: -8, PDT: -7 };
  const ISO = /^([+-]\d{6}|\d{4})(?:-(\d\d)(?:-(\d\d))?)?(?:[T ](\d\d):(\d\d)(?::(\d\d)(?:[.,](\d{1,9}))?)?(Z|[+-]\d\d:?\d\d)?)?$/;
  const NAMED = /\b(jan|feb|mar|apr|may|jun|jul|aug|sep|oct|nov|dec)[a-z]*\b/i;
  const CLOCK = /(\d{1,2}):(\d\d)(?::(\d\d)(?:\.(\d{1,3}))?)?(?:\s*([ap])\.?m\b\.?)?/i;
  const OFFSET = /[+-]\d\d:?\d\d\b/, ZONE = /\b(?:GMT|UTC?|Z|[ECMP][SD]T)\b/i;

  const define = (object, name, value) => Object.defineProperty(
    object, name, { value: value, writable: true, configurable: true, enumerable: false });
  const method = (object, length, holder) => {
    for (const name of Object.keys(holder)) {
      Object.defineProperty(holder[name], 'length', { value: length, configurable: true });
      define(object, name, holder[name]);
    }
  };
  const two = (number) => (number < 10 ? '0' : '') + number;
  const at = (year, month, day, hours, minutes, seconds, ms) => {
    const made = make(Native, [0]);
    apply(setDay, made, [year, month, day]);
    return apply(setHours, made, [hours, minutes, seconds, ms]);
  };
  const minutesOf = (zone) => {
    if (!zone || zone === 'Z') return 0;
    const minutes = 60 * zone.slice(1, 3) + Number(zone.slice(-2));
    return zone[0] === '-' ? -minutes : minutes;
  };

  function iso(found) {
    const [, year, month = 1, day = 1, hours = 0, minutes = 0, seconds = 0, part = '', zone] = found;
    const late = hours > 24 || minutes > 59 || seconds > 59;
    if (year === '-000000' || month < 1 || month > 12 || day < 1 || day > 31 || late) return NaN;
    if (hours == 24 && (minutes > 0 || seconds > 0 || part > 0)) return NaN;
    const ms = Number((part + '000').slice(0, 3));
    return at(+year, month - 1, +day, +hours, minutes - minutesOf(zone), +seconds, ms);
  }
  function parse(value) {
    let text = String(value).trim();
    if (text.length > 100) return NaN;
    let found = ISO.exec(text);
    if (found) return iso(found);
    text = text.replace(/\([^)]*\)/g, ' ');
    let hours = 0, minutes = 0, seconds = 0, ms = 0, rest = text;
    if ((found = CLOCK.exec(text))) {
      [hours, minutes, seconds, ms] = [+found[1], +found[2], +(found[3] || 0), +(found[4] || 0)];
      if (hours > 24 || minutes > 59 || seconds > 59 || (found[5] && hours > 12)) return NaN;
      if (found[5]) hours = hours % 12 + (found[5].toLowerCase() === 'p' ? 12 : 0);
      rest = text.slice(0, found.index) + ' ';
      let zone = text.slice(found.index + found[0].length);
      const offset = OFFSET.exec(zone), name = ZONE.exec(zone);
      if (offset) minutes -= minutesOf(offset[0]);
      else if (name) hours -= ZONES[name[0].toUpperCase()] || 0;
      rest += zone.replace(OFFSET, ' ').replace(ZONE, ' ');
    }
    const named = NAMED.exec(rest), numbers = rest.match(/\d+/g) || [];
    if (numbers.length !== (named ? 2 : 3)) return NaN;
    if (named) {
      const month = MONTHS.findIndex((one) => one.toLowerCase() === named[1].toLowerCase()) + 1;
      if (numbers[0] > 31) numbers.reverse();
      numbers.unshift(month);
    } else {
      if (!/^\s*\d+([\/-])\d+\1\d+[\s,]*$/.test(rest)) return NaN;
      if (numbers[0] > 31) numbers.push(numbers.shift());
    }
    const [month, day, given] = [+numbers[0], +numbers[1], +numbers[2]];
    if (month < 1 || month > 12 || day < 1 || day > 31) return NaN;
    const year = given < 50 ? 2000 + given : given < 100 ? 1900 + given : given;
    return at(year, month - 1, day, hours, minutes, seconds, ms);
  }

  function dayOf(date) {
    const year = date.getUTCFullYear(), sign = year < 0 ? '-' : '';
    return DAYS[date.getUTCDay()] + ' ' + MONTHS[date.getUTCMonth()] + ' '
      + two(date.getUTCDate()) + ' ' + sign + ('000' + Math.abs(year)).slice(year > 9999 ? 3 : -4);
  }
  const clockOf = (date) => two(date.getUTCHours()) + ':' + two(date.getUTCMinutes()) + ':'
    + two(date.getUTCSeconds());
  const usDay = (date) => date.getUTCMonth() + 1 + '/' + date.getUTCDate() + '/'
    + date.getUTCFullYear();
  const usClock = (date) => (date.getUTCHours() % 12 || 12) + ':' + two(date.getUTCMinutes()) + ':'
    + two(date.getUTCSeconds()) + (date.getUTCHours() < 12 ? ' AM' : ' PM');
  const full = (date) => dayOf(date) + ' ' + clockOf(date) + ' GMT+0000 (UTC)';
  const said = (date, how) => {  // of a copy, whose methods are those of the prototype
    const time = apply(getTime, date, []);
    return time === time ? how(make(Native, [time])) : 'Invalid Date';
  };

  function plain(value) {
    if (value === null || (typeof value !== 'object' && typeof value !== 'function')) return value;
    try { return apply(getTime, value, []); } catch (error) { /* it is no date */ }
    const inner = value.valueOf();
    return inner !== null && typeof inner === 'object' ? String(value) : inner;
  }
  function Date(year, month, date, hours, minutes, seconds, ms) {
    if (new.target === undefined) return said(make(Native, [clock()]), full);
    let time = clock();
    if (arguments.length === 1) {
      const value = plain(year);
      time = typeof value === 'string' ? parse(value) : Number(value);
    } else if (arguments.length) time = apply(UTC, undefined, arguments);
    return make(Native, [time], new.target);
  }
  Object.defineProperty(Date, 'prototype', { value: own, writable: false });
  define(own, 'constructor', Date);
  define(Date, 'UTC', UTC);
  method(Date, 0, { now() { return clock(); } });
  method(Date, 1, { parse(text) { return parse(text); } });
  for (const part of ['FullYear', 'Month', 'Date', 'Day', 'Hours', 'Minutes', 'Seconds',
      'Milliseconds']) {
    const read = own['getUTC' + part], write = own['setUTC' + part];
    method(own, 0, { ['get' + part]() { return apply(read, this, []); } });
    if (write)
      method(own, write.length, { ['set' + part](...given) { return apply(write, this, given); } });
  }
  const fullYear = own.getFullYear;
  method(own, 1, { setYear(year) {
    const given = Math.trunc(Number(year));
    return apply(setDay, this, [given >= 0 && given <= 99 ? 1900 + given : given]);
  } });
  method(own, 0, {
    getYear() { return apply(fullYear, this, []) - 1900; },
    getTimezoneOffset() { return apply(getTime, this, []) * 0; },
    toString() { return said(this, full); },
    toDateString() { return said(this, dayOf); },
    toTimeString() { return said(this, (date) => clockOf(date) + ' GMT+0000 (UTC)'); },
    toLocaleString() { return said(this, (date) => usDay(date) + ', ' + usClock(date)); },
    toLocaleDateString() { return said(this, usDay); },
    toLocaleTimeString() { return said(this, usClock); },
  });
  return Date;
})
"""
"""``Date`` as ECMAScript has it, in UTC: it reads neither the host's clock nor its time zone.

An expression that gives a function of the host's own ``Date`` and a function that gives the time.
"""

CLOCK = r"""
(function (source) {
  'use strict';
  const Native = Date, evaluate = eval, define = Object.defineProperty;
  let now = 0;
  const give = (value) =>
    define(globalThis, 'Date', { value: value, writable: true, configurable: true });
  return function install(ms) {
    if (ms !== undefined) { now = ms; return; }
    define(globalThis, 'Date', {
      configurable: true,
      set: give,
      get: () => { give(evaluate(source)(Native, () => now)); return Date; },
    });
  };
})
"""
"""Puts :data:`DATE` in the place of the host's, read when a document first asks for it.

A function of the text of :data:`DATE`, evaluated before :data:`PRELUDE`, which takes the host's
own ``Date`` away. It gives a function that, called without a value, installs the new one; with
one, sets the time (ms since 1970).
"""
