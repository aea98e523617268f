(function () {
const give = globalThis['\u01c0give'], declare = globalThis['\u01c0declare'], Text = String;
const stringify = JSON.stringify, isArray = Array.isArray, text = String, parse = JSON.parse;
const number = Number, own = Object.hasOwn, freeze = Object.freeze, keys = Object.keys;
const prototype = Object.getPrototypeOf, base = Object.prototype, Known = Map, List = Array;
const define = Object.defineProperty;
// Scopes inherit next to nothing: a variable may have any name, also "constructor".
const root = Object.create(null, {
  hasOwnProperty: { value: base.hasOwnProperty, writable: true },
  [Symbol.toPrimitive]: { value: () => '[object Object]' },
});
const empty = Object.create.bind(null, root);
const plain = (v) => isArray(v) || prototype(v) === base || prototype(v) === root;
// Data as a copy, also data that holds itself; what is no plain data stays what it is.
const copy = (v, done) => {
  if (typeof v !== 'object' || v === null || !plain(v)) return v;
  if (done.has(v)) return done.get(v);
  const made = isArray(v) ? new List(v.length) : {};
  done.set(v, made);
  for (const key of keys(v)) define(made, key, { __proto__: null,  // also one named __proto__
    value: copy(v[key], done), writable: true, enumerable: true, configurable: true });
  return made;
};
// Data that nobody may change, and that follows what it is a view of.
const Weak = WeakMap, View = Proxy, Wrong = TypeError, descriptor = Reflect.getOwnPropertyDescriptor;
const views = new Weak(), refuse = () => { throw new Wrong('session variables are read-only'); };
const look = {
  get: (own, key) => view(own[key]),
  getOwnPropertyDescriptor: (own, key) => {
    const found = descriptor(own, key);
    if (found) found.value = view(found.value);
    return found;
  },
  set: refuse, defineProperty: refuse, deleteProperty: refuse, setPrototypeOf: refuse,
  preventExtensions: refuse,
};
const view = (v) => {
  if (typeof v !== 'object' || v === null || !plain(v)) return v;
  let made = views.get(v);
  if (made === undefined) {
    made = new View(v, look);
    views.set(v, made);
    views.set(made, made);
  }
  return made;
};
const marks = ['NaN', 'Infinity', '-Infinity'];
const unmarked = (_, v) => typeof v === 'object' && v !== null && own(v, '\0')
  && marks.includes(v['\0']) && keys(v).length === 1 ? number(v['\0']) : v;
return {
  scope: function () { return empty(); },
  nothing: function () { return freeze(empty()); },
  named: function (name) { const made = empty(); declare(made, name, made); return made; },
  event: function (name, message, data) {
    return { __proto__: root, event: { name, message, data: data === null ? {} : data },
      _event: name, _message: message };
  },
  clock: function (o, t) { o.session = { time: t }; },
  set: function (o, k, v) { declare(o, k, v); },
  unset: function (o, k) { declare(o, k); },
  has: function (o, k) { return own(o, k); },
  defined: function (o, k) { return own(o, k) && o[k] !== undefined; },
  hand: function (o, k, from) { declare(o, k, from[k]); },
  view: function (o) { return view(o); },
  detach: function (o, k) { o[k] = copy(o[k], new Known()); },
  text: function (v) { return v === undefined ? 'undefined' : typeof v !== 'object' || v === null
    ? give(text(v)) : v instanceof Text ? v : stringify(v); },
  parse: function (v) { return parse(v, unmarked); },
  json: function (v) { return stringify(v); },
  items: function (v) { return isArray(v) ? v.length : -1; },
  listed: function (v) { const made = [];
    for (let i = 0; i < v.length; i++) made[i] = v[i]; return made; },
  pick: function (o, k, v, i) { declare(o, k, v[i]); },
}; })()
