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
