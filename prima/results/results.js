"use strict";
(() => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const find = (id) => document.getElementById(id);

  function make(tag, attributes, ...children) {
    const made = document.createElement(tag);
    for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
    made.append(...children);
    return made;
  }

  // Tables to copy -------------------------------------------------------------------------

  const cell = (one) => one.textContent.trim().replace(/\s+/g, " ");
  const lines = (table) =>
    [...table.rows].map((row) => [...row.cells].map(cell).join("\t")).join("\n") + "\n";

  /** Copy by the clipboard, or where a page from a disk may not use it, by a selection. */
  async function copy(text) {
    try {
      await navigator.clipboard.writeText(text);
      return true;
    } catch {
      const area = make("textarea", { class: "hidden" });
      area.value = text;
      document.body.append(area);
      area.select();
      const done = document.execCommand("copy");
      area.remove();
      return done;
    }
  }

  for (const button of document.querySelectorAll("button.copy")) {
    button.hidden = false;
    button.addEventListener("click", async () => {
      const table = find(button.dataset.table);
      const done = await copy(lines(table));
      button.focus();
      find("said").textContent = done
        ? `Copied ${table.rows.length} rows of “${table.caption.textContent}”.`
        : "The browser let nothing be copied; select the table instead.";
      button.textContent = done ? "Copied" : "Not copied";
      setTimeout(() => { button.textContent = "Copy"; }, 2000);
    });
  }

  // The map of orders ----------------------------------------------------------------------

  const rows = find("map-rows"), columns = find("map-columns");
  if (!rows) return;

  /** The cell of two factors' levels, or of one's; what is stored has the earlier factor first. */
  function cellOf(a, b, row, column) {
    if (b < 0) return data.maps[`${a}`][row];
    const flipped = a > b;
    const held = data.maps[flipped ? `${b},${a}` : `${a},${b}`];
    const wide = data.factors[flipped ? a : b].levels.length;
    return flipped ? held[column * wide + row] : held[row * wide + column];
  }

  function cellElement(found) {
    if (!found) return make("td", { class: "empty" }, "–");
    const [place, runs, whole, distinct] = found;
    const order = data.orders[place] || [place === data.none ? "–" : `${place + 1}`, ""];
    const made = make("td", { class: `fill${Math.min(place, data.coloured)}` });
    const told = `Order ${order[0]}, ${runs} of ${whole} runs`;
    made.append(order[1] ? make("a", { href: order[1], "aria-label": told }, order[0]) : order[0]);
    if (distinct > 1) made.append(" ", make("span", { class: "more" }, `+${distinct - 1}`));
    return made;
  }

  function draw() {
    const a = Number(rows.value), b = Number(columns.value) === a ? -1 : Number(columns.value);
    const names = [data.factors[a].name, ...(b < 0 ? [] : [data.factors[b].name])];
    const heads = b < 0 ? ["Order"] : data.factors[b].levels;
    const head = make("tr", {}, make("th", { scope: "col" }, names.join(" \\ ")));
    for (const one of heads) head.append(make("th", { scope: "col" }, one));
    const body = make("tbody", {});
    data.factors[a].levels.forEach((level, row) => {
      const line = make("tr", {}, make("th", { scope: "row" }, level));
      heads.forEach((_, column) => line.append(cellElement(cellOf(a, b, row, column))));
      body.append(line);
    });
    const caption = `The most frequent order by ${names.join(" and ")}`;
    find("map").replaceChildren(make("caption", {}, caption), make("thead", {}, head), body);
    find("said").textContent = caption;
  }

  document.querySelector(".choose").hidden = false;
  for (const one of [rows, columns]) one.addEventListener("change", draw);
})();
