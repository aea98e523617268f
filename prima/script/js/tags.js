(function () {
'use strict';
const stringify = JSON.stringify, parse = JSON.parse, isArray = Array.isArray;
const assign = Object.assign, define = Object.defineProperty;
const hidden = (object, name, value) => define(object, name, { value: value, writable: true });
const keys = Object.keys, create = Object.create;
const own = Object.hasOwn, number = Number;
const apply = Reflect.apply, truth = Boolean.prototype.valueOf;
const wrapped = [[Number, Number], [String, String], [Boolean, (v) => apply(truth, v, [])]];
// Rules may have any name; so nothing else is there that looks like one, but for this method.
const named = create(null);
hidden(named, 'hasOwnProperty', Object.prototype.hasOwnProperty);
const strange = '\0';
// What JSON lacks, as objects that nobody writes:
const mark = (value) => {
  if (value === undefined || typeof value === 'function') return { [strange]: 'undefined' };
  if (typeof value === 'number' && value - value !== 0) return { [strange]: String(value) };
  if (value === null || typeof value !== 'object') return value;
  if (typeof value.toJSON === 'function') return value;
  for (let i = 0; i < wrapped.length; i++)
    if (value instanceof wrapped[i][0]) return mark(wrapped[i][1](value));
  const made = isArray(value) ? [] : {};
  for (const key of keys(value))
    define(made, key, { value: mark(value[key]), writable: true, configurable: true, enumerable: true });
  if (isArray(value)) made.length = value.length;
  return made;
};
const unmark = (value) => {
  if (value === null || typeof value !== 'object') return value;
  const told = own(value, strange) ? value[strange] : undefined;
  if (told === 'undefined') return undefined;
  if (told === 'NaN' || told === 'Infinity' || told === '-Infinity') return number(told);
  for (const key of keys(value)) value[key] = unmark(value[key]);
  return value;
};
// More parts than a value may have characters: stopped here, as nothing stops the engine inside JSON.
const Failure = RangeError, most = 100000;
const counted = () => {
  let left = most;
  return (_, value) => {
    if (left-- <= 0) throw new Failure('the value has more than 100,000 parts');
    return value;
  };
};
// Nothing but our own yield gives the function that the tags of a rule have for the next one.
const goOn = Object.getPrototypeOf(function* () {}).prototype.next, Wrong = SyntaxError;
const go = (environment) => {
  const step = apply(goOn, environment.steps, []);
  if (step.done) return step.value;
  if (step.value !== environment.next) throw new Wrong('yield outside of a generator');
  return null;
};
const plain = (value) => value !== null && typeof value === 'object' && !isArray(value);
return {
  box: function (text) { return { v: parse(text) }; },
  json: function (box) { return stringify(box.v, counted()); },
  carry: function (box) {
    const text = stringify(mark(box.v));
    return text === undefined ? stringify(mark(undefined)) : text;
  },
  take: function (text) { return { v: unmark(parse(text)) }; },
  environment: function (text, merges) {
    let last, lastMeta = { text: '', score: 1 }, name = 'latest';
    const own = { text: text, score: 1 }, rules = create(named), meta = create(named);
    hidden(rules, 'latest', function () { return last; });
    hidden(meta, 'latest', function () { return lastMeta; });
    hidden(meta, 'current', function () { return own; });
    return {
      rules: rules, meta: meta,
      steps: null,
      add: function (rule, box, text) { name = rule; last = box.v; lastMeta = { text: text, score: 1 }; },
      next: function (out) {
        if (name !== 'latest') rules[name] = last;
        if (name !== 'latest' && name !== 'current') meta[name] = lastMeta;
        if (merges && plain(out) && plain(last)) assign(out, last);
      },
    };
  },
  begin: function (environment, tags) {
    environment.steps = tags(environment.rules, environment.meta, environment.next, {});
    return go(environment);
  },
  resume: function (environment, rule, box, text) {
    environment.add(rule, box, text);
    return go(environment);
  },
}; })()
