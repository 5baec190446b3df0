// Small helpers for the page's elements.
export const $ = (id) => document.getElementById(id);

// A number with so many digits, whole ones with all; with an exponent if that is shorter than `longest` characters.
export function numberText(value, digits, longest) {
  if (Number.isInteger(value)) return String(value);
  const rounded = Number(value.toPrecision(digits)), written = String(rounded);
  return written.length > longest ? rounded.toExponential() : written;
}

// What a cell says.
export const text = (value) => (typeof value === 'number' ? numberText(value, 4, 9) : value ?? '');

export function element(tag, content, attributes = {}) {
  const made = document.createElement(tag);
  if (content !== undefined) made.textContent = content;
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  return made;
}

// An element with words that may be names: long ones are broken behind such characters, rather than within a word.
export function nameElement(tag, words, attributes = {}) {
  const made = element(tag, undefined, attributes);
  words.split(/(?<=[_/:,])|(?<=\.)(?!\d)/).forEach((part, k) => made.append(...k > 0 ? [element('wbr')] : [], part));
  return made;
}

// Runs `act` when the line is clicked, or at Enter.
export function onChoice(line, act) {
  line.tabIndex = 0;
  line.onclick = act;
  line.onkeydown = (event) => { if (event.key === 'Enter') act(); };
}

// Lets a button copy the command that stands before it.
export function onCopy(button) {
  button.onclick = async () => {
    try {
      await navigator.clipboard.writeText(button.previousElementSibling.textContent);
      button.textContent = 'copied';
    } catch {
      button.textContent = 'not copied: select it and copy';
    }
    setTimeout(() => { button.textContent = 'copy'; }, 1500);
  };
}

// Marks one line of a table's body; -1: none.
export function mark(body, chosen) {
  [...body.children].forEach((line, k) => line.classList.toggle('chosen', k === chosen));
}

// Fills a table's body with rows of cells; `choose(k)` is what a click on line k does.
export function fill(body, rows, choose) {
  body.replaceChildren(...rows.map((cells, k) => {
    const line = element('tr');
    line.append(...cells.map((cell) => (typeof cell === 'number' ? element('td', text(cell), {class: 'number'}) : nameElement('td', text(cell)))));
    if (choose) onChoice(line, () => { mark(body, k); choose(k); });
    return line;
  }));
}

// The tables that a row or the page brings: {title, columns, rows, frames?, command?}. `go(frame)` moves the slider, `note` is what is to
// be known of their commands.
export function fillTables(place, tables, note, go) {
  place.replaceChildren(...tables.map(({title, columns, rows, frames, command}) => {
    const section = element('section'), table = element('table'), head = element('tr'), body = element('tbody');
    head.append(...columns.map((column) => element('th', column)));
    fill(body, rows, frames && ((k) => go(frames[k])));
    table.append(element('thead'), body);
    table.firstChild.append(head);
    section.append(element('h2', title), table);
    if (command) {
      const copy = element('button', 'copy', {class: 'copy'});
      onCopy(copy);
      section.append(element('p', `The same again: ${note}`, {class: 'faint'}), element('pre', command), copy);
    }
    return section;
  }));
}
