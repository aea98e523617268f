"""What ECMAScript of strangers starts with: built-ins that hold the engine's limits.

Built-ins that do not look at the engine's time limit are replaced by ones that bound
their work. ``Date`` is absent and ``Math.random`` seeded, so that a run can be repeated.
"""

from __future__ import annotations

MEMORY_LIMIT = 16 * 1024 * 1024
"""Bytes that one engine may use."""
STACK_LIMIT = 256 * 1024

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
