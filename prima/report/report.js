"use strict";
(() => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const runs = data.runs;
  const changes = data.changes || null;
  const find = (id) => document.getElementById(id);
  const longest = Math.max(0.001, ...runs.map((run) => run.seconds));
  const wide = matchMedia("(min-width: 72rem)");
  const still = matchMedia("(prefers-reduced-motion: reduce)");
  const SVG = "http://www.w3.org/2000/svg";
  const coarse = matchMedia("(pointer: coarse)").matches; // a finger needs more room than a mouse
  const HEIGHT = coarse ? 32 : 20, PITCH = HEIGHT + 3, MOST_ROWS = 4;
  const FLOOR = coarse ? 32 : 16, DEVICE = coarse ? 24 : 9, ROPE = coarse ? 24 : 8, TIER = coarse ? 24 : 15;
  const NEAR = coarse ? 12 : 4; // pixels beside a mark that still hit it
  const READABLE = 7, LEAST_SHOWN = 30; // pixels for a second, and seconds, when the page opens

  // A bar, as Python writes it: begin, end, name, application, text, row, devices, cuts.
  const [BEGIN, END, NAME, APP, TEXT, ROW, DEVICES, CUTS] = [0, 1, 2, 3, 4, 5, 6, 7];

  const state = { from: 0, to: longest, now: 0, playing: false, follow: true, chosen: [-1, -1], devices: runs.length < 2 };

  function make(tag, attributes = {}, ...children) {
    const made = document.createElement(tag);
    for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
    made.append(...children);
    return made;
  }

  function draw(tag, attributes = {}, text = "") {
    const made = document.createElementNS(SVG, tag);
    for (const [name, value] of Object.entries(attributes)) {
      made.setAttribute(name, typeof value === "number" ? Math.round(value * 10) / 10 : value);
    }
    if (text) made.textContent = text;
    return made;
  }

  const seconds = (time) => `${time.toFixed(2)} s`;
  const isWide = (letter) => letter.codePointAt(0) > 0x2e7f;
  const letters = new Intl.Segmenter();

  /** The language of what a row says, as an attribute. */
  const tongue = (index, number) => {
    const row = runs[index].rows[number];
    return row && row[5] ? { lang: row[5] } : {};
  };

  /** A text cut to the pixels that it has. */
  function fit(text, space) {
    if (space < 12) return "";
    let used = 0, made = "";
    for (const { segment } of letters.segment(text.length > 400 ? text.slice(0, 400) : text)) {
      used += isWide(segment) ? 11.5 : 6;
      if (used > space - 6) return made ? `${made.trimEnd()}…` : "";
      made += segment;
    }
    return made;
  }

  const widthOf = (text) => [...text].reduce((sum, one) => sum + (isWide(one) ? 11.5 : 6), 0);
  const colour = (index, app) => (app < 0 ? data.nobody : runs[index].colours[app]);

  /** The index of the last element whose time is not after a moment, or -1. */
  function lastBefore(list, time, of) {
    let low = 0, high = list.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (of(list[middle]) <= time + 1e-9) low = middle + 1; else high = middle;
    }
    return low - 1;
  }

  // Rows of both tables --------------------------------------------------------------------

  const rowOf = runs.map((run) => run.rows.map((_, number) => number));
  if (changes) {
    changes.forEach(([, before, after], index) => {
      if (before >= 0) rowOf[0][before] = index;
      if (after >= 0) rowOf[1][after] = index;
    });
  }
  const kindOf = runs.map((run) => new Array(run.rows.length).fill("same"));
  if (changes) {
    for (const [kind, before, after] of changes) {
      if (before >= 0) kindOf[0][before] = kind;
      if (after >= 0) kindOf[1][after] = kind;
    }
  }
  /** The rows of each run that a row of the table is about; -1 where there is none. */
  const numbersOf = (index) => (changes ? changes[index].slice(1) : [index]);
  const table = document.querySelector("table.rows");
  const rowCount = changes ? changes.length : runs[0].rows.length;
  const line = (index) => find(`row-${index}`);
  const buttonOf = (row) => row.querySelector("button.open");

  // Timeline ---------------------------------------------------------------------------------

  /** Put what overlaps into rows of a lane; more than a lane may have share the last one. */
  function pack(bars) {
    const ends = [], rows = new Map();
    for (const bar of bars) {
      let row = ends.findIndex((end) => end <= bar[BEGIN] + 1e-9);
      if (row < 0) row = Math.min(ends.length, MOST_ROWS - 1);
      ends[row] = Math.max(bar[END], ends[row] || 0);
      rows.set(bar, row);
    }
    return [rows, Math.max(1, ends.length)];
  }

  const plans = runs.map((run) => {
    const flags = [];
    run.rows.forEach(([time, who, , text, event], number) => {
      if (who !== "R" || event) flags.push([time, who, text, number]);
    });
    const lanes = run.apps.map((name, app) => {
      const own = (bars) => bars.filter((bar) => bar[APP] === app);
      const [rows, count] = pack(own(run.bars));
      const [ropes, lines] = pack(own(run.streams));
      return { name, app, rows, count, bars: own(run.bars), away: own(run.away), held: own(run.held), streams: own(run.streams), ropes, lines };
    });
    const uses = run.devices.map((_, device) => run.bars.filter((bar) => bar[DEVICES].includes(device)));
    return { flags, lanes, uses };
  });

  /** One picture of a run from a moment to another, as an SVG element of a width. */
  function picture(index, from, to, width, paper) {
    const run = runs[index], plan = plans[index];
    const left = paper ? 132 : width < 480 ? 62 : 96, right = width - 8;
    const scale = (right - left) / (to - from);
    const at = (time) => left + (time - from) * scale;
    const behind = [], parts = [];
    let serial = paper ? `paper-${index}-${from}` : `${index}`;
    serial = `hatch-${serial.replace(/[^\w-]/g, "-")}`;
    const name = (text, y, kind = "name") => parts.push(draw("text", { x: 6, y, class: kind }, fit(text, left - 12)));
    /** Let an element mark a row: a pointer or a key opens it, and its whole text can be read. */
    const mark = (element, lane, begin, row, text) => {
      if (paper) return element;
      Object.assign(element.dataset, { lane, begin, text });
      if (row < 0) return element;
      element.dataset.row = row;
      for (const [key, value] of [["role", "button"], ["tabindex", -1], ["aria-label", text]]) element.setAttribute(key, value);
      return element;
    };
    const during = (bar) => `${bar[BEGIN].toFixed(2)} to ${seconds(bar[END])}`;

    const box = (bar, lane, y, height, kind, last, label) => {
      if (bar[END] < from || bar[BEGIN] > to) return last;
      const x0 = Math.max(at(bar[BEGIN]), left), x1 = Math.min(at(bar[END]), right);
      if (x1 - x0 < 2 && x0 - last < 1.5) return last;
      const mine = bar[ROW] >= 0 && state.chosen[index] === bar[ROW];
      const rect = draw("rect", { x: x0, y, width: Math.max(x1 - x0, 1.5), height, rx: 3, class: `${kind}${mine && !paper ? " chosen" : ""}` });
      parts.push(mark(rect, lane, bar[BEGIN], bar[ROW], `${bar[NAME]}: ${bar[TEXT]}, ${during(bar)}`));
      const cuts = bar[CUTS];
      if (label && cuts.length && (x1 - x0) / cuts.length > 4) {
        for (const cut of cuts) {
          if (cut > from && cut < to) parts.push(draw("line", { x1: at(cut), x2: at(cut), y1: y + height - 5, y2: y + height, class: "tick" }));
        }
      }
      if (label) {
        const kindHere = bar[ROW] >= 0 ? kindOf[index][bar[ROW]] : "same";
        const change = kindHere === "same" ? "" : `${data.marks[kindHere]} `;
        const text = fit(change + bar[TEXT], x1 - x0 - 4);
        if (text) parts.push(draw("text", { x: x0 + 4, y: y + height / 2 + 4, ...tongue(index, bar[ROW]) }, text));
      }
      return x1;
    };

    let y = 6;
    // What the user and the surroundings do.
    const tiers = [left, left, left];
    const flagged = [];
    name("events", y + 12);
    let lastFlag = -9;
    const shownFlags = plan.flags.filter(([time]) => time >= from && time <= to);
    for (const [time, who, text, number] of shownFlags) {
      const x = at(time);
      const tier = tiers.findIndex((end) => end <= x);
      if (tier < 0 && x - lastFlag < 5) continue;
      lastFlag = tier < 0 ? x : lastFlag;
      const top = y + (tier < 0 ? tiers.length : tier) * TIER;
      flagged.push([x, top]);
      const mine = state.chosen[index] === number && !paper;
      const shape = who === "U" ? `M${x} ${top + 12}V${top}H${x + 7}L${x + 4} ${top + 3.5}L${x + 7} ${top + 7}H${x}` : `M${x} ${top + 12}V${top}L${x + 8} ${top + 4}L${x} ${top + 8}`;
      const flag = draw("path", { d: shape, class: `flag ${who === "U" ? "user" : ""}${mine ? " chosen" : ""}` });
      parts.push(mark(flag, "events", time, number, `${seconds(time)}: ${text}`));
      if (tier >= 0) {
        const words = fit(text, Math.min(right - x - 10, 190));
        const spoken = draw("text", { x: x + 10, y: top + 9, class: "halo said", ...tongue(index, number) }, words);
        if (!paper) Object.assign(spoken.dataset, { row: number, text: `${seconds(time)}: ${text}` });
        if (words) parts.push(spoken);
        tiers[tier] = x + 18 + widthOf(words);
      }
    }
    y += TIER * (tiers.length + 1) + 5;

    for (const lane of plan.lanes) {
      const top = y, height = lane.count * PITCH + 4;
      parts.push(draw("line", { x1: 0, x2: width, y1: y - 3, y2: y - 3, class: "lane-line" }));
      name(lane.name, y + 15);
      for (const bar of lane.away) {
        if (bar[END] < from || bar[BEGIN] > to) continue;
        const x0 = Math.max(at(bar[BEGIN]), left), x1 = Math.min(at(bar[END]), right);
        const rect = draw("rect", { x: x0, y: top, width: Math.max(x1 - x0, 1), height, fill: `url(#${serial})`, class: "away" });
        parts.push(mark(rect, `app ${lane.app}`, bar[BEGIN], bar[ROW], `${bar[NAME]} is suspended by ${bar[TEXT]}, ${during(bar)}`));
      }
      let lastHeld = -9;
      for (const bar of lane.held) {
        if (bar[END] < from || bar[BEGIN] > to) continue;
        const x0 = Math.max(at(bar[BEGIN]), left), x1 = Math.min(at(bar[END]), right);
        if (x1 - lastHeld < 1.5) continue;
        lastHeld = x1;
        const dash = draw("line", { x1: x0, x2: x1, y1: top + height - 2, y2: top + height - 2, class: "held" });
        const near = draw("line", { x1: x0, x2: Math.max(x1, x0 + 1), y1: top + height - 2, y2: top + height - 2, class: "near" });
        parts.push(dash, mark(near, `app ${lane.app}`, bar[BEGIN], bar[ROW], `${bar[NAME]} is held back by ${bar[TEXT]}, ${during(bar)}`));
      }
      const last = new Array(lane.count).fill(-9);
      for (const bar of lane.bars) {
        const row = lane.rows.get(bar);
        last[row] = box(bar, `app ${lane.app}`, top + 2 + row * PITCH, HEIGHT, `bar fill${colour(index, lane.app)}`, last[row], true);
      }
      y += height + 4;
      const ends = new Array(lane.lines).fill(-9);
      for (const bar of lane.streams) {
        if (bar[END] < from || bar[BEGIN] > to) continue;
        const row = lane.ropes.get(bar), low = y + row * ROPE + (coarse ? 10 : 3);
        const x0 = Math.max(at(bar[BEGIN]), left), x1 = Math.min(at(bar[END]), right);
        if (x1 - ends[row] < 1.5) continue;
        ends[row] = x1;
        const rope = draw("path", { d: `M${x0.toFixed(1)} ${low}H${x1.toFixed(1)}M${x1.toFixed(1)} ${low - 3}v6`, class: `stream line${colour(index, lane.app)}` });
        const near = draw("path", { d: `M${x0.toFixed(1)} ${low}H${Math.max(x1, x0 + 1).toFixed(1)}`, class: "near" });
        parts.push(rope, mark(near, `stream ${lane.app}`, bar[BEGIN], bar[ROW], `${bar[TEXT]}, ${during(bar)}`));
        let before = -9;
        for (const cut of bar[CUTS]) {
          if (cut < from || cut > to || at(cut) - before < 7) continue;
          before = at(cut);
          parts.push(draw("circle", { cx: before, cy: low, r: 2.5, class: `window line${colour(index, lane.app)}` }));
        }
      }
      y += lane.lines * ROPE + 6;
    }
    parts.push(draw("line", { x1: 0, x2: width, y1: y - 3, y2: y - 3, class: "lane-line" }));
    if (run.floor.length) {
      name("floor", y + 12);
      let last = -9;
      for (const bar of run.floor) last = box(bar, "floor", y, FLOOR, `bar fill${colour(index, bar[APP])}`, last, true);
      y += FLOOR + 6;
    }
    if (state.devices || paper) {
      run.devices.forEach((device, number) => {
        name(device, y + 10, "quiet");
        let last = -9;
        for (const bar of plan.uses[number]) last = box(bar, `device ${number}`, y + 2, DEVICE, `bar fill${colour(index, bar[APP])}`, last, false);
        y += DEVICE + 5;
      });
    }
    const step = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 30, 60, 120, 300, 600, 1800, 3600, 7200, 21600].find((one) => one * scale > 56) || 86400;
    for (let time = Math.ceil(from / step - 1e-9) * step; time <= to + 1e-9; time += step) {
      const label = step < 1 ? time.toFixed(1) : `${Math.round(time)}`;
      behind.push(draw("line", { x1: at(time), x2: at(time), y1: TIER * 4 + 6, y2: y + 3, class: "grid" }));
      if (at(time) < right - 6) parts.push(draw("text", { x: at(time), y: y + 15, "text-anchor": "middle", class: "quiet" }, label));
    }
    parts.push(draw("text", { x: 6, y: y + 15, class: "quiet" }, "seconds"));
    for (const [x, top] of flagged) behind.push(draw("line", { x1: x, x2: x, y1: top + 10, y2: y, class: "pole" }));
    const svg = draw("svg", { viewBox: `0 0 ${Math.round(width)} ${Math.round(y + 22)}`, role: "group", "aria-label": `${run.title}, from ${from.toFixed(1)} to ${to.toFixed(1)} seconds. The transcript tells the same in words.` });
    const hatch = draw("pattern", { id: serial, width: 7, height: 7, patternUnits: "userSpaceOnUse", patternTransform: "rotate(45)" });
    hatch.append(draw("line", { x1: 0, x2: 0, y1: 0, y2: 7, class: "hatch-line" }));
    const definitions = draw("defs");
    definitions.append(hatch);
    svg.append(definitions, ...behind, ...parts);
    return { svg, at, left, right, bottom: y };
  }

  // The whole text of a mark, beside it: under a pointer, and where the keyboard is.
  const pointed = find("pointed");
  function point(mark) {
    pointed.textContent = mark.dataset.text;
    pointed.classList.add("shown");
    const place = mark.getBoundingClientRect(), size = pointed.getBoundingClientRect();
    const above = place.bottom + 6 + size.height > innerHeight;
    pointed.style.left = `${Math.max(4, Math.min(Math.max(place.left, 4), innerWidth - size.width - 4))}px`;
    pointed.style.top = `${above ? place.top - size.height - 6 : place.bottom + 6}px`;
  }
  function unpoint() {
    pointed.classList.remove("shown");
  }
  addEventListener("scroll", unpoint, { passive: true, capture: true });

  const timelines = runs.map((run, index) => {
    const host = find(`timeline-${index}`);
    let shown = null, cursor = null, stop = null;
    const key = (mark) => [mark.dataset.lane, mark.dataset.begin, mark.dataset.row].join("|");
    const marks = () => [...host.querySelectorAll("[role=button]")];
    /** Let one mark be the one that Tab comes to. */
    const rest = (mark) => {
      if (stop) stop.tabIndex = -1;
      stop = mark || null;
      if (stop) stop.tabIndex = 0;
    };
    const step = (from, key) => {
      const all = marks(), at = (mark) => Number(mark.dataset.begin), lane = from.dataset.lane;
      const along = key === "ArrowLeft" || key === "ArrowRight", back = key === "ArrowLeft" || key === "ArrowUp";
      const lanes = [...new Set(all.map((mark) => mark.dataset.lane))];
      const wanted = along ? lane : lanes[lanes.indexOf(lane) + (back ? -1 : 1)];
      const own = all.filter((mark) => mark.dataset.lane === wanted).sort((a, b) => at(a) - at(b));
      if (along) return own[own.indexOf(from) + (back ? -1 : 1)];
      return own.reduce((best, mark) => (!best || Math.abs(at(mark) - at(from)) < Math.abs(at(best) - at(from)) ? mark : best), null);
    };
    const moment = (event) => {
      const x = (event.clientX - host.getBoundingClientRect().left - 1);
      return state.from + ((x - shown.left) / (shown.right - shown.left)) * (state.to - state.from);
    };
    const line = {
      redraw() {
        const focused = host.contains(document.activeElement) && document.activeElement !== host ? key(document.activeElement) : "";
        unpoint();
        shown = picture(index, state.from, state.to, Math.max(host.clientWidth, 240), false);
        cursor = draw("line", { y1: 2, y2: shown.bottom + 4, class: "cursor" });
        shown.svg.append(cursor);
        host.replaceChildren(shown.svg);
        const again = focused && marks().find((mark) => key(mark) === focused);
        stop = null;
        rest(again || marks()[0]);
        if (focused) (again || host).focus({ preventScroll: true });
        line.point();
      },
      /** Pixels that time has. */
      space: () => shown.right - shown.left,
      point() {
        if (!shown) return;
        const inside = state.now >= state.from - 1e-9 && state.now <= state.to + 1e-9;
        const x = shown.at(state.now).toFixed(1);
        cursor.setAttribute("visibility", inside ? "visible" : "hidden");
        cursor.setAttribute("x1", x);
        cursor.setAttribute("x2", x);
      },
    };
    /** The mark under a pointer, or a little beside it. */
    const hitBy = ({ clientX, clientY }) => {
      for (const reach of [0, NEAR]) {
        for (const [x, y] of [[0, 0], [0, -reach], [0, reach], [-reach, 0], [reach, 0]]) {
          const hit = document.elementFromPoint(clientX + x, clientY + y)?.closest("[data-row]");
          if (hit && host.contains(hit)) return hit;
        }
      }
      return null;
    };
    host.addEventListener("pointerover", (event) => {
      const mark = event.target.closest("[data-text]");
      if (mark) point(mark);
      else unpoint();
    });
    host.addEventListener("pointerleave", unpoint);
    host.addEventListener("focusin", (event) => {
      if (event.target === host) return;
      rest(event.target);
      if (event.target.matches(":focus-visible")) point(event.target);
    });
    host.addEventListener("focusout", unpoint);
    let grip = null;
    host.addEventListener("pointerdown", (event) => {
      if (event.button !== 0) return;
      grip = { x: event.clientX, from: state.from, to: state.to, moved: false };
      host.setPointerCapture(event.pointerId);
    });
    host.addEventListener("pointermove", (event) => {
      if (!grip) return;
      const way = event.clientX - grip.x;
      if (Math.abs(way) > 4) grip.moved = true;
      if (!grip.moved) return;
      const scale = (grip.to - grip.from) / (shown.right - shown.left);
      view(grip.from - way * scale, grip.to - way * scale);
    });
    let dragged = false;
    const release = () => {
      dragged = Boolean(grip && grip.moved);
      grip = null;
    };
    host.addEventListener("pointerup", release);
    host.addEventListener("pointercancel", release);
    // Only at the click, when the finger is gone: else it would click what comes into view.
    host.addEventListener("click", (event) => {
      if (dragged) return;
      const mark = event.detail ? hitBy(event) : event.target.closest("[data-row]");
      if (mark) show(index, Number(mark.dataset.row));
      else if (event.detail) go(moment(event));
    });
    host.addEventListener("wheel", (event) => {
      if (event.ctrlKey || event.metaKey) zoom(event.deltaY > 0 ? 1.25 : 0.8, moment(event));
      else if (event.shiftKey || Math.abs(event.deltaX) > Math.abs(event.deltaY)) pan((event.deltaX || event.deltaY) / 600);
      else return;
      event.preventDefault();
    }, { passive: false });
    host.addEventListener("keydown", (event) => {
      const keys = {
        ArrowLeft: () => pan(-0.1), ArrowRight: () => pan(0.1), "+": () => zoom(0.7), "=": () => zoom(0.7), "-": () => zoom(1.4),
        Home: () => view(0, state.to - state.from), End: () => view(longest - (state.to - state.from), longest), 0: () => view(0, longest), " ": () => play(),
      };
      if (event.ctrlKey || event.metaKey || event.altKey) return;
      const mark = event.target.closest("[role=button]");
      if (mark && event.key.startsWith("Arrow")) {
        event.preventDefault();
        return step(mark, event.key)?.focus();
      }
      if (mark && (event.key === "Enter" || event.key === " ")) {
        event.preventDefault();
        return show(index, Number(mark.dataset.row), true);
      }
      if (mark && event.key === "Escape") return host.focus();
      if (!mark && event.key === "ArrowDown") {
        event.preventDefault();
        return (stop || marks()[0])?.focus();
      }
      if (!keys[event.key]) return;
      event.preventDefault();
      keys[event.key]();
    });
    new ResizeObserver(later).observe(host);
    return line;
  });

  let waiting = false;
  /** Draw again with the next frame. */
  function later() {
    if (waiting) return;
    waiting = true;
    requestAnimationFrame(() => {
      waiting = false;
      timelines.forEach((one) => one.redraw());
    });
  }

  function tellShown() {
    const whole = state.to - state.from >= longest - 1e-9;
    const part = `${state.from.toFixed(0)} to ${state.to.toFixed(0)} s of ${longest.toFixed(0)} s`;
    find("shown").textContent = whole ? "The whole run is shown." : `Shown: ${part}; Later goes on, Whole run shows all.`;
  }

  function view(from, to) {
    const span = Math.min(Math.max(to - from, Math.min(1, longest)), longest);
    const start = Math.min(Math.max(from, 0), longest - span);
    [state.from, state.to] = [start, start + span];
    tellShown();
    later();
  }

  /** Bring the cursor into what is shown. */
  function follow() {
    const span = state.to - state.from;
    if (state.now > state.to || state.now < state.from) view(state.now, state.now + span);
  }

  /** As much of the beginning as can be read; the whole run, where it is not much longer. */
  function beginning() {
    const span = Math.max(LEAST_SHOWN, timelines[0].space() / READABLE);
    if (longest > span * 1.25) view(0, span);
  }

  const pan = (share) => view(state.from + share * (state.to - state.from), state.to + share * (state.to - state.from));

  function zoom(factor, around) {
    const inside = state.now >= state.from && state.now <= state.to;
    const fixed = around ?? (inside ? state.now : (state.from + state.to) / 2);
    view(fixed - (fixed - state.from) * factor, fixed + (state.to - fixed) * factor);
  }

  // Map ------------------------------------------------------------------------------------------

  /** Where somebody was at a moment: [x, y, heading], on a straight line between two poses. */
  function poseAt(poses, time) {
    const index = lastBefore(poses, time, (pose) => pose[0]);
    if (index < 0) return poses.length ? poses[0].slice(1) : null;
    const [begin, x, y, heading] = poses[index], next = poses[index + 1];
    if (!next || next[0] <= begin) return [x, y, heading];
    const share = (time - begin) / (next[0] - begin);
    const turn = ((next[3] - heading + 540) % 360) - 180;
    return [x + (next[1] - x) * share, y + (next[2] - y) * share, heading + turn * share];
  }

  const maps = runs.map((run, index) => {
    const host = find(`map-${index}`);
    if (!host) return { point() {} };
    const { plan, robot, person, camera, radius } = run.walk;
    const xs = [], ys = [];
    const note = (x, y) => { xs.push(x); ys.push(y); };
    for (const [, x, y] of [...robot, ...person]) note(x, y);
    if (plan) {
      for (const [x1, y1, x2, y2] of plan.walls) { note(x1, y1); note(x2, y2); }
      for (const [, x, y] of [...plan.places, ...plan.things]) note(x, y);
    }
    const least = (list) => list.reduce((a, b) => Math.min(a, b), Infinity);
    const most = (list) => list.reduce((a, b) => Math.max(a, b), -Infinity);
    const margin = 0.6;
    const [left, right, low, high] = [least(xs) - margin, most(xs) + margin, least(ys) - margin, most(ys) + margin];
    const width = 480;
    const scale = Math.min(width / Math.max(right - left, 3), 330 / Math.max(high - low, 1));
    const height = Math.max((high - low) * scale, 120);
    const space = (width - (right - left) * scale) / 2;
    const drop = (height - (high - low) * scale) / 2;
    const X = (x) => space + (x - left) * scale, Y = (y) => height - drop - (y - low) * scale;
    const svg = draw("svg", { viewBox: `0 0 ${width} ${Math.round(height)}`, role: "img" });
    const label = (text, x, y, kind = "quiet halo") => {
      const words = fit(text, 150), half = words.length * 3;
      const middle = Math.min(Math.max(X(x), half + 4), width - half - 4);
      svg.append(draw("text", { x: middle, y: Y(y) + 14, class: kind, "text-anchor": "middle" }, words));
    };
    if (plan) {
      for (const [, x1, y1, x2, y2, app] of plan.areas) {
        const shade = run.apps.includes(app) ? `line${colour(index, run.apps.indexOf(app))}` : "";
        svg.append(draw("rect", { x: X(x1), y: Y(y2), width: (x2 - x1) * scale, height: (y2 - y1) * scale, class: `area ${shade}` }));
      }
      for (const [x1, y1, x2, y2] of plan.ways) svg.append(draw("line", { x1: X(x1), y1: Y(y1), x2: X(x2), y2: Y(y2), class: "way" }));
      for (const [, x, y, r] of plan.corners) svg.append(draw("circle", { cx: X(x), cy: Y(y), r: r * scale, class: "corner" }));
      for (const [x1, y1, x2, y2] of plan.walls) svg.append(draw("line", { x1: X(x1), y1: Y(y1), x2: X(x2), y2: Y(y2), class: "wall" }));
    }
    const trail = (poses, kind) => {
      const every = Math.ceil(poses.length / 3000) || 1;
      const points = poses.filter((_, place) => place % every === 0 || place === poses.length - 1);
      if (points.length > 1) svg.append(draw("polyline", { points: points.map(([, x, y]) => `${X(x).toFixed(1)},${Y(y).toFixed(1)}`).join(" "), class: `trail ${kind}` }));
    };
    trail(person, "person");
    trail(robot, "");
    if (plan) {
      for (const [id, x, y] of plan.places) { svg.append(draw("circle", { cx: X(x), cy: Y(y), r: 3, class: "spot" })); label(id, x, y); }
      for (const [id, x, y] of plan.things) { svg.append(draw("rect", { x: X(x) - 4, y: Y(y) - 4, width: 8, height: 8, class: "spot" })); label(id, x, y); }
    }
    const size = Math.max(radius * scale, 6);
    const cone = draw("path", { class: "camera" });
    const figure = draw("circle", { r: size, class: "robot" });
    const nose = draw("line", { class: "nose" });
    const other = draw("path", { class: "person" });
    const names = [draw("text", { class: "name halo", "text-anchor": "middle" }, "robot"), draw("text", { class: "name halo", "text-anchor": "middle" }, "user")];
    if (robot.length) svg.append(cone, figure, nose, names[0]);
    if (person.length) svg.append(other, names[1]);
    host.append(svg);
    /** A click goes to the moment at which somebody was there, and opens the row of that moment. */
    svg.addEventListener("click", (event) => {
      const frame = svg.getBoundingClientRect(), share = width / frame.width;
      const [x, y] = [(event.clientX - frame.left) * share, (event.clientY - frame.top) * share];
      const off = ([, px, py]) => Math.hypot(X(px) - x, Y(py) - y);
      const here = [poseAt(robot, state.now), poseAt(person, state.now)].filter(Boolean).map((pose) => [state.now, ...pose]);
      const nearest = (poses) => poses.reduce((best, pose) => (best && off(best) <= off(pose) ? best : pose), null);
      const found = [nearest(here), nearest([...robot, ...person])].find((pose) => pose && off(pose) < size + 14);
      if (!found) return;
      const number = lastBefore(run.rows, found[0], (row) => row[0]);
      if (number >= 0) show(index, number);
      go(found[0]);
    });
    return {
      point() {
        const time = Math.min(state.now, run.seconds);
        const pose = poseAt(robot, time), user = poseAt(person, time);
        const shown = [];
        if (pose) {
          const [x, y, heading] = [X(pose[0]), Y(pose[1]), (pose[2] * Math.PI) / 180];
          figure.setAttribute("cx", x.toFixed(1));
          figure.setAttribute("cy", y.toFixed(1));
          for (const [end, reach] of [[1, 0], [2, size + 4]]) {
            nose.setAttribute(`x${end}`, (x + Math.cos(heading) * reach).toFixed(1));
            nose.setAttribute(`y${end}`, (y - Math.sin(heading) * reach).toFixed(1));
          }
          names[0].setAttribute("x", x.toFixed(1));
          names[0].setAttribute("y", (y - size - 6).toFixed(1));
          if (camera && run.walk.source === "run") {
            const [angle, range] = [(camera[0] * Math.PI) / 360, camera[1] * scale];
            const edge = (turn) => `${(x + Math.cos(heading + turn) * range).toFixed(1)} ${(y - Math.sin(heading + turn) * range).toFixed(1)}`;
            cone.setAttribute("d", `M${x.toFixed(1)} ${y.toFixed(1)}L${edge(angle)}A${range.toFixed(1)} ${range.toFixed(1)} 0 0 1 ${edge(-angle)}Z`);
          }
          shown.push(`the robot is at ${pose[0].toFixed(1)}, ${pose[1].toFixed(1)}`);
        }
        if (user) {
          const [x, y] = [X(user[0]), Y(user[1])];
          other.setAttribute("d", `M${x.toFixed(1)} ${(y - 7).toFixed(1)}l7 12h-14z`);
          names[1].setAttribute("x", x.toFixed(1));
          names[1].setAttribute("y", (y + 17).toFixed(1));
          shown.push(`the user is at ${user[0].toFixed(1)}, ${user[1].toFixed(1)}`);
        }
        svg.setAttribute("aria-label", `Map in metres: ${shown.join("; ") || "nobody is on it"}.`);
      },
    };
  });

  // Now --------------------------------------------------------------------------------------------

  const shown = runs.map(() => "");
  function tellNow(index) {
    const run = runs[index], now = state.now;
    const during = (bar) => bar[BEGIN] <= now && (now < bar[END] || (bar[END] === run.seconds && now === bar[END]));
    const items = [];
    for (const bar of run.bars) if (during(bar)) items.push([bar[APP], run.apps[bar[APP]] || "", bar[TEXT], bar[ROW]]);
    const floor = run.floor.find(during);
    if (floor) items.push([floor[APP], "floor", floor[TEXT], floor[ROW]]);
    for (const bar of run.away) if (during(bar)) items.push([bar[APP], "suspended", `${bar[NAME]}, by ${bar[TEXT]}`, bar[ROW]]);
    const number = lastBefore(run.rows, now, (one) => one[0]);
    const list = items.slice(0, 12).map(([app, name, text, number]) => make("li", {}, make("span", { class: `app app${colour(index, app)}` }, `${name}: `), linkTo(index, number, said(index, number, text))));
    if (!items.length) list.push(make("li", { class: "dim" }, now >= run.seconds ? "The run is over." : "The robot does nothing."));
    if (number >= 0) list.push(make("li", { class: "dim" }, `Last, at ${seconds(run.rows[number][0])}: `, linkTo(index, number, spoken(index, number))));
    const text = list.map((one) => one.textContent).join("\n");
    if (text === shown[index]) return;
    shown[index] = text;
    find(`now-${index}`).replaceChildren(...list);
  }

  const slider = find("moment");
  const clocks = [...document.querySelectorAll(".clock")];
  let current = null;

  /** Go to a moment: cursor, map, what goes on, and the row that came last. */
  function go(time) {
    state.now = Math.min(Math.max(time, 0), longest);
    slider.value = state.now;
    for (const clock of clocks) clock.textContent = clock.closest("#controls") ? `${state.now.toFixed(2)} of ${seconds(longest)}` : seconds(state.now);
    timelines.forEach((one) => one.point());
    maps.forEach((one) => one.point());
    runs.forEach((_, index) => tellNow(index));
    const last = runs.length - 1, run = runs[last];
    const number = lastBefore(run.rows, state.now, (row) => row[0]);
    const here = number < 0 ? null : line(rowOf[last][number]);
    slider.setAttribute("aria-valuetext", `${seconds(state.now)}${number < 0 ? "" : `: ${run.rows[number][2]} ${run.rows[number][3]}`}`);
    if (here === current) return;
    if (current) current.removeAttribute("aria-current");
    current = here;
    if (!here) return;
    here.setAttribute("aria-current", "true");
    if (state.playing && state.follow && wide.matches) here.scrollIntoView({ block: "nearest" });
  }

  let frame = 0, clock = 0, shownAt = 0;
  function tick(time) {
    if (!state.playing) return;
    const passed = Math.min((time - clock) / 1000, 0.5);
    clock = time;
    const next = state.now + passed * Number(find("speed").value);
    if (still.matches && time - shownAt < 500 && next < longest) state.now = next;
    else {
      shownAt = time;
      go(next);
    }
    follow();
    if (state.now >= longest) return play(false);
    frame = requestAnimationFrame(tick);
  }

  function play(on = !state.playing) {
    state.playing = on;
    find("play").textContent = on ? "Pause" : "Play";
    cancelAnimationFrame(frame);
    if (!on) return go(state.now);
    if (state.now >= longest) go(0);
    state.follow = true;
    clock = performance.now();
    frame = requestAnimationFrame(tick);
  }

  // Why ----------------------------------------------------------------------------------------------

  /** A link to a row of a run, or only its text where the run has no such row. */
  function linkTo(index, number, text) {
    if (number < 0) return text;
    return make("a", { href: `#row-${rowOf[index][number]}` }, text);
  }

  /** A text about a row of a run; what is said in it carries its language. */
  function said(index, number, text) {
    const made = make("bdi", {}), row = runs[index].rows[number];
    const words = row && row.length > 5 ? row[3].substr(row[6], row[7]) : "";
    const place = words ? text.indexOf(`"${words}"`) + 1 : 0;
    if (!place) made.append(text);
    else made.append(text.slice(0, place), make("span", { lang: row[5] }, words), text.slice(place + words.length));
    return made;
  }

  function spoken(index, number) {
    const [, , app, text] = runs[index].rows[number];
    return said(index, number, `${app ? `${app}: ` : ""}${text}`);
  }

  /** Why a row of a run came where it did, as an element. */
  function whyOf(index, number) {
    const run = runs[index], why = run.whys[number], [time] = run.rows[number];
    const made = make("div", {});
    made.append(make("h3", {}, changes ? `Why in run ${"AB"[index]}: row ${number}, ${seconds(time)}` : `Why row ${number} came at ${seconds(time)}`));
    if (why.origin) made.append(make("p", {}, why.origin));
    if (why.source) made.append(make("p", {}, "Requested at ", make("code", {}, why.source), "."));
    if (why.cause !== undefined) {
      made.append(make("p", {}, "It reacts to ", linkTo(index, why.cause, `row ${why.cause}`), ": ", spoken(index, why.cause), "."));
    }
    const list = make("ul", {});
    for (const [when, text, rule, rivals] of why.reasons || []) {
      const item = make("li", {}, `${seconds(when)}: ${text}`);
      if (Object.hasOwn(data.rules, rule)) item.append(make("div", { class: "note" }, `${rule}: ${data.rules[rule]}.`));
      if (rivals.length) {
        const others = make("ul", {});
        for (const name of rivals) {
          const [what, source, row] = run.names[name];
          const one = make("li", {}, make("code", {}, name), ": ", said(index, row, what));
          if (source) one.append(", ", make("code", {}, source));
          if (row >= 0) one.append(", ", linkTo(index, row, `row ${row}`));
          others.append(one);
        }
        item.append(others);
      }
      list.append(item);
    }
    if (list.children.length) made.append(list);
    const during = (bar) => bar[BEGIN] <= time && time < bar[END];
    const waits = [
      ...run.away.filter(during).map((bar) => `${bar[NAME]} is suspended by ${bar[TEXT]}`),
      ...run.held.filter(during).map((bar) => `${bar[NAME]} is held back by ${bar[TEXT]}`),
    ].slice(0, 8);
    if (waits.length) {
      made.append(make("p", {}, "What waits at that moment:"), make("ul", {}, ...waits.map((text) => make("li", {}, text))));
    }
    if (!why.origin && !why.source && !why.reasons && !waits.length) made.append(make("p", {}, "The transcript holds no decision about it."));
    return made;
  }

  const isOpen = (row) => buttonOf(row).getAttribute("aria-expanded") === "true";

  function open(index, on) {
    const row = line(index), button = buttonOf(row);
    if (isOpen(row) === on) return;
    button.setAttribute("aria-expanded", String(on));
    if (!on) {
      button.removeAttribute("aria-controls");
      return row.nextElementSibling.remove();
    }
    const reasons = make("div", { class: "reasons" });
    numbersOf(index).forEach((number, run) => {
      if (number >= 0) reasons.append(whyOf(run, number));
    });
    row.after(make("tr", { role: "row", class: "why", id: `why-${index}` }, make("td", { role: "cell", colspan: "6" }, reasons)));
    button.setAttribute("aria-controls", `why-${index}`);
  }

  let stop = null;
  /** Let one button of the table be the one that Tab comes to. */
  function rove(button) {
    if (stop) stop.tabIndex = -1;
    stop = button;
    stop.tabIndex = 0;
  }

  /** Choose a row of the table: the cursor goes to its moment. ``time``: by which run's. */
  function choose(index, { scroll = false, time = -1 } = {}) {
    const numbers = numbersOf(index), row = line(index);
    state.chosen = [numbers[0], numbers[1] ?? -1];
    rove(buttonOf(row));
    const run = time >= 0 && numbers[time] >= 0 ? time : numbers[numbers.length - 1] >= 0 ? numbers.length - 1 : 0;
    const moment = runs[run].rows[numbers[run]][0];
    if (moment < state.from || moment > state.to) view(moment - (state.to - state.from) / 4, moment + ((state.to - state.from) * 3) / 4);
    go(moment);
    later();
    if (scroll) row.scrollIntoView({ block: wide.matches ? "nearest" : "center" });
  }

  /** Open the row of a run's row, wherever it is; with a key, go there. */
  function show(run, number, withKey = false) {
    const index = rowOf[run][number];
    reveal(index);
    open(index, true);
    choose(index, { scroll: true, time: run });
    if (withKey) buttonOf(line(index)).focus({ preventScroll: true });
  }

  table.addEventListener("click", (event) => {
    const row = event.target.closest("tr.row");
    if (!row || event.target.closest("a") || String(getSelection())) return;
    const index = Number(row.id.slice(4));
    choose(index);
    open(index, !isOpen(row));
  });

  table.addEventListener("keydown", (event) => {
    const button = event.target.closest("button.open");
    if (!button || event.ctrlKey || event.metaKey || event.altKey) return;
    const here = Number(button.closest("tr").id.slice(4)), last = rowCount - 1;
    const target = { ArrowDown: [here + 1, 1], ArrowUp: [here - 1, -1], Home: [0, 1], End: [last, -1] }[event.key];
    if (!target) return;
    let [index, way] = target;
    while (line(index) && isOut(index)) index += way;
    const row = line(index);
    event.preventDefault();
    if (!row) return;
    rove(buttonOf(row));
    buttonOf(row).focus();
  });

  function fromAddress() {
    const found = /^#row-(\d+)$/.exec(location.hash);
    const row = found && line(Number(found[1]));
    if (!row) return;
    reveal(Number(found[1]));
    choose(Number(found[1]), { scroll: true });
    open(Number(found[1]), true);
    buttonOf(row).focus({ preventScroll: wide.matches });
  }

  // Which rows are shown -------------------------------------------------------------------------------

  const isOut = (index) => line(index).hidden || (table.classList.contains("only") && changes[index][0] === "same");

  const only = () => {
    table.classList.toggle("only", find("only").checked);
    settle();
  };

  /** Show the rows of an application, of who did them, and that contain a text. */
  function filter() {
    const app = find("by-app").value, who = find("by-who").value, text = find("by-text").value.trim().toLowerCase();
    const some = Boolean(app || who || text);
    const fits = (number, run) => {
      if (number < 0) return false;
      const [, by, name, what] = runs[run].rows[number];
      return (!app || name === app) && (!who || by === who) && (!text || what.toLowerCase().includes(text));
    };
    for (let index = 0; index < rowCount; index += 1) {
      const row = line(index);
      row.hidden = some && !numbersOf(index).some(fits);
      if (isOpen(row)) row.nextElementSibling.hidden = row.hidden;
    }
    table.classList.toggle("some", some);
    settle();
  }

  /** Say how many rows are shown, and let Tab come to one of them. */
  function settle() {
    const shown = [...Array(rowCount).keys()].filter((index) => !isOut(index));
    find("found").textContent = shown.length < rowCount ? `${shown.length} of ${rowCount} rows` : "";
    if (shown.length && stop && isOut(Number(stop.closest("tr").id.slice(4)))) rove(buttonOf(line(shown[0])));
  }

  /** Show a row, though it was chosen not to show such rows. */
  function reveal(index) {
    if (!isOut(index)) return;
    for (const id of ["by-app", "by-who"]) find(id).addEventListener("change", filter);
  find("by-text").addEventListener("input", filter);
  document.querySelector(".filter").addEventListener("submit", (event) => event.preventDefault());
  document.addEventListener("click", (event) => {
    if (event.target.closest("a")?.hash === location.hash && location.hash) fromAddress();
  });
  if (find("only")) find("only").checked = false;
    for (const id of ["by-app", "by-who", "by-text"]) find(id).value = "";
    table.classList.remove("only");
    filter();
  }

  // Paper -----------------------------------------------------------------------------------------------

  /** The whole run, in strips that can be read, for paper. */
  function strips() {
    const paper = find("paper");
    paper.replaceChildren();
    runs.forEach((run, index) => {
      paper.append(make("h2", {}, changes ? `Timeline of run ${"AB"[index]}` : "Timeline"));
      const span = Math.max(30, run.seconds / 12);
      const count = Math.max(1, Math.ceil(run.seconds / span - 1e-9));
      for (let part = 0; part < count; part += 1) {
        paper.append(picture(index, part * span, (part + 1) * span, 1000, true).svg);
      }
    });
  }
  addEventListener("beforeprint", strips);
  addEventListener("afterprint", () => find("paper").replaceChildren());

  // Beginning -----------------------------------------------------------------------------------------------

  for (const hidden of document.querySelectorAll("#controls, .pictures, .keys, .filter")) hidden.hidden = false;
  if (rowCount) rove(buttonOf(line(0)));
  slider.max = longest;
  slider.addEventListener("input", () => {
    go(Number(slider.value));
    follow();
  });
  find("play").addEventListener("click", () => play());
  find("earlier").addEventListener("click", () => pan(-0.5));
  find("later").addEventListener("click", () => pan(0.5));
  find("closer").addEventListener("click", () => zoom(0.6));
  find("wider").addEventListener("click", () => zoom(1.6));
  find("whole").addEventListener("click", () => view(0, longest));
  find("devices").setAttribute("aria-pressed", String(state.devices));
  find("devices").addEventListener("click", () => {
    state.devices = !state.devices;
    find("devices").setAttribute("aria-pressed", String(state.devices));
    later();
  });
  for (const id of ["by-app", "by-who"]) find(id).addEventListener("change", filter);
  find("by-text").addEventListener("input", filter);
  document.querySelector(".filter").addEventListener("submit", (event) => event.preventDefault());
  document.addEventListener("click", (event) => {
    if (event.target.closest("a")?.hash === location.hash && location.hash) fromAddress();
  });
  if (find("only")) find("only").addEventListener("change", only);
  for (const kind of ["wheel", "touchmove"]) addEventListener(kind, () => { state.follow = false; }, { passive: true });
  addEventListener("hashchange", fromAddress);
  timelines.forEach((one) => one.redraw());
  tellShown();
  beginning();
  go(0);
  fromAddress();
})();
