// Small helpers for the page's elements.
export const $ = (id) => document.getElementById(id);

// A cell: numbers with four digits.
export const text = (value) => (typeof value === 'number' ? Number(value.toPrecision(4)).toString() : value ?? '');

export function element(tag, content, attributes = {}) {
  const made = document.createElement(tag);
  if (content !== undefined) made.textContent = content;
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  return made;
}

// Runs `act` when the line is clicked, or at Enter.
export function onChoice(line, act) {
  line.tabIndex = 0;
  line.onclick = act;
  line.onkeydown = (event) => { if (event.key === 'Enter') act(); };
}

// Marks one line of a table's body; -1: none.
export function mark(body, chosen) {
  [...body.children].forEach((line, k) => line.classList.toggle('chosen', k === chosen));
}

// Fills a table's body with rows of cells; `choose(k)` is what a click on line k does.
export function fill(body, rows, choose) {
  body.replaceChildren(...rows.map((cells, k) => {
    const line = element('tr');
    line.append(...cells.map((cell) => element('td', text(cell))));
    if (choose) onChoice(line, () => { mark(body, k); choose(k); });
    return line;
  }));
}

// The tables that a row or the page brings: {title, columns, rows, frames?, command?}. `go(frame)` moves the slider.
export function fillTables(place, tables, go) {
  place.replaceChildren(...tables.map(({title, columns, rows, frames, command}) => {
    const section = element('section'), table = element('table'), head = element('tr'), body = element('tbody');
    head.append(...columns.map((column) => element('th', column)));
    fill(body, rows, frames && ((k) => go(frames[k])));
    table.append(element('thead'), body);
    table.firstChild.append(head);
    section.append(element('h2', title), table);
    if (command) section.append(element('p', 'The same again:', {class: 'faint'}), element('pre', command));
    return section;
  }));
}
