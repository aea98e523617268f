(function (Native, clock) {
  'use strict';
  const own = Native.prototype, UTC = Native.UTC;
  const apply = Reflect.apply, make = Reflect.construct, getTime = own.getTime;
  const setTime = own.setTime, setDay = own.setUTCFullYear, setHours = own.setUTCHours;
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
  const written = (write, date, given) => {  // the engine leaves a date as it is if a part is NaN
    const time = apply(write, date, given);
    return time === time ? time : apply(setTime, date, [NaN]);
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
    const named = NAMED.exec(rest), numbers = rest.match(/\s-\d{4,}|\d+/g) || [];
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
    const short = numbers[2].length < 3;
    if (month < 1 || month > 12 || day < 1 || day > 31) return NaN;
    const year = short ? (given < 50 ? 2000 : 1900) + given : given;
    return at(year, month - 1, day, hours, minutes, seconds, ms);
  }

  function dayOf(date) {
    const year = date.getUTCFullYear(), digits = String(Math.abs(year)).padStart(4, '0');
    return DAYS[date.getUTCDay()] + ' ' + MONTHS[date.getUTCMonth()] + ' '
      + two(date.getUTCDate()) + ' ' + (year < 0 ? '-' : '') + digits;
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
    if (write) method(own, write.length, {
      ['set' + part](...given) { return written(write, this, given); },
      ['setUTC' + part](...given) { return written(write, this, given); },
    });
  }
  const fullYear = own.getFullYear;
  method(own, 1, { setYear(year) {
    const given = Math.trunc(Number(year));
    return written(setDay, this, [given >= 0 && given <= 99 ? 1900 + given : given]);
  } });
  method(own, 0, {
    getYear() { return apply(fullYear, this, []) - 1900; },
    getTimezoneOffset() { return apply(getTime, this, []) * 0 + 0; },
    toString() { return said(this, full); },
    toDateString() { return said(this, dayOf); },
    toTimeString() { return said(this, (date) => clockOf(date) + ' GMT+0000 (UTC)'); },
    toLocaleString() { return said(this, (date) => usDay(date) + ', ' + usClock(date)); },
    toLocaleDateString() { return said(this, usDay); },
    toLocaleTimeString() { return said(this, usClock); },
  });
  return Date;
})
