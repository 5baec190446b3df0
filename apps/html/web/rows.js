// The list of rows: filtered, sorted, with thumbnails. Lines are made as it is scrolled, thumbnails when they are seen: there may be thousands.
import {$, element, nameElement, onChoice, text} from './dom.js';

const BATCH = 100;  // lines made at once

export class RowList {
  // `choose(index)` shows a row; `draw(index, canvas)`, a promise, draws its thumbnail.
  constructor({rows, columns, models}, choose, draw) {
    Object.assign(this, {rows, columns, models, choose, current: -1, shown: []});
    this.several = models.length > 1;
    const head = [['', ''], ['row', 'index'], ['name and status', 'label'], ...columns.map((column, k) => [column, String(k)])];
    $('list-head').append(...head.map(([words, key]) => this.heading(words, key)));
    const orders = [['index', 'by number'], ['label', 'by name'], ['status', 'by status'], ['wrong', 'what stands out first'], ...columns.map((column, k) => [k, `${column}, largest first`])];
    $('sort').append(...orders.map(([value, words]) => element('option', words, {value})));
    this.queue = [];
    this.observer = new IntersectionObserver((entries) => {
      for (const {isIntersecting, target} of entries) if (isIntersecting) this.ask(target, draw);
    }, {root: $('list')});
    $('filter').oninput = $('sort').onchange = () => this.list();
    $('list').onscroll = () => { if ($('list').scrollTop + $('list').clientHeight > $('list').scrollHeight - 200) this.more(); };
    $('list-part').hidden = rows.length < 2;
    this.list();
  }

  // A click on it sorts the rows.
  heading(words, key) {
    const heading = element('th', words, {'data-key': key});
    if (key) onChoice(heading, () => { $('sort').value = key; this.list(); });
    return heading;
  }

  // One thumbnail after the other, between what the reader does.
  async ask(canvas, draw) {
    this.observer.unobserve(canvas);
    this.queue.push(canvas);
    if (this.queue.length > 1) return;
    while (this.queue.length > 0) {
      await new Promise((done) => { setTimeout(done); });
      if (this.queue[0].isConnected) await draw(Number(this.queue[0].dataset.row), this.queue[0]);
      this.queue.shift();
    }
  }

  // What the filter looks in: number, model (of several), name, status.
  words(index) {
    const {label, status, model} = this.rows[index];
    return [index, ...(this.several ? [this.models[model]] : []), label, status.replaceAll('_', ' ')];
  }

  list() {
    const wanted = $('filter').value.toLowerCase().split(/\s+/).filter(Boolean);
    this.shown = this.rows.map((_, index) => index).filter((index) => {
      const line = this.words(index).join(' ').toLowerCase();
      return wanted.every((word) => line.includes(word));
    });
    const key = $('sort').value, row = (index) => this.rows[index];
    if (key === 'label' || key === 'status') {
      this.shown.sort((a, b) => row(a)[key].localeCompare(row(b)[key], undefined, {numeric: true}) || a - b);
    } else if (key === 'wrong') {
      this.shown.sort((a, b) => row(b).wrong - row(a).wrong || a - b);
    } else if (key !== 'index') {
      this.shown.sort((a, b) => (row(b).values[key] ?? -Infinity) - (row(a).values[key] ?? -Infinity) || a - b);
    }
    for (const heading of $('list-head').children) {
      heading.ariaSort = heading.dataset.key !== key ? null : key === 'index' || key === 'label' ? 'ascending' : 'descending';
    }
    $('rows').replaceChildren();
    const wrong = this.rows.filter((row) => row.wrong).length;
    $('count').textContent = `${this.shown.length} of ${this.rows.length}`;
    $('count-wrong').textContent = wrong ? `, ${wrong} stand${wrong > 1 ? '' : 's'} out` : '';
    this.more();
  }

  more() {
    const begin = $('rows').children.length;
    for (const index of this.shown.slice(begin, begin + BATCH)) {
      const line = element('tr', undefined, {'data-index': index}), picture = element('td');
      const canvas = element('canvas', undefined, {class: 'thumb', 'data-row': index, 'aria-hidden': true});
      picture.append(canvas);
      const [, ...words] = this.words(index), status = words.pop(), name = words.pop();
      const cell = element('td', undefined, {class: 'name'});
      cell.append(nameElement('div', name), ...words.map((model) => nameElement('div', model, {class: 'faint'})), element('div', status, {class: 'status faint'}));
      line.append(picture, element('td', index), cell, ...this.rows[index].values.map((value) => element('td', text(value))));
      line.classList.toggle('wrong', this.rows[index].wrong);
      line.classList.toggle('chosen', index === this.current);
      onChoice(line, () => this.choose(index));
      $('rows').append(line);
      this.observer.observe(canvas);
    }
  }

  mark(index) {
    this.current = index;
    while (this.shown.indexOf(index) >= $('rows').children.length) this.more();
    for (const line of $('rows').children) line.classList.toggle('chosen', Number(line.dataset.index) === index);
  }

  // Chooses the next row, or the one before.
  step(by) {
    const at = this.shown.indexOf(this.current) + by;
    if (at < 0 || at >= this.shown.length) return;
    this.choose(this.shown[at]);
    $('rows').children[at]?.scrollIntoView({block: 'nearest'});
  }
}
