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
    if (typeof said !== 'string') return said;
    const whole = short(said, said.length);
    return apply(indexOf, whole, ['\0']) < 0 ? whole : box(whole);
  };
  // A declared variable lasts as long as its scope: nothing deletes it. A scope that is a variable
  // of itself is not listed among its variables.
  const own = Object.hasOwn;
  const declare = (scope, name, value) => {
    if (own(scope, name)) scope[name] = value;
    else define(scope, name,
      { __proto__: null, value: value, writable: true, enumerable: value !== scope });
  };
  // A scope whose variables cannot be assigned; to be read, they must be declared further in.
  const Missing = ReferenceError;
  const refuse = (names) => {
    const made = { __proto__: null };
    for (let i = 0; i < names.length; i++) define(made, names[i], {
      __proto__: null, get: undefined,
      set: () => { throw new Missing(names[i] + ' is not defined'); },
    });
    return made;
  };
  const given = {
    '\u01c0give': give,
    '\u01c0declare': declare,
    '\u01c0refuse': refuse,
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
