// A list that the keys walk through: one stop of the tabulator, arrows choose.

/**
 * @param {HTMLElement} list of rows with data-key @param {() => string} chosen @param {(key: string) => void} choose
 * @param {(key: string) => void} [open] Enter, or a double click @param {(key: string) => void} [gather] a click with Ctrl
 */
export function walkable(list, chosen, choose, open, gather) {
  const rows = () => /** @type {HTMLElement[]} */ ([...list.children]).filter((row) => row.dataset.key && !row.classList.contains('head'));
  list.addEventListener('keydown', (event) => {
    if (event.target !== list) return;
    const keys = rows().map((row) => row.dataset.key ?? '');
    const at = keys.indexOf(chosen());
    const to = { ArrowDown: at + 1, ArrowUp: at < 0 ? 0 : at - 1, Home: 0, End: keys.length - 1 }[event.key];
    if (to !== undefined && keys.length > 0) {
      choose(keys[Math.min(keys.length - 1, Math.max(0, to))]);
      event.preventDefault();
      event.stopPropagation();
    } else if (event.key === 'Enter' && at >= 0) {
      open?.(keys[at]);
      event.stopPropagation();
    }
  });
  const keyOf = (/** @type {Event} */ event) => /** @type {HTMLElement | null} */ (/** @type {Element} */ (event.target).closest('[data-key]:not(.head)'))?.dataset.key;
  list.addEventListener('click', (event) => {
    if (/** @type {Element} */ (event.target).closest('button')) return;
    const key = keyOf(event);
    if (key && gather && (event.ctrlKey || event.metaKey)) gather(key);
    else if (key) choose(key);
  });
  list.addEventListener('dblclick', (event) => {
    const key = keyOf(event);
    if (key) open?.(key);
  });
}

/** Marks the chosen row, and says to the list's reader which one it is. @param {HTMLElement} list @param {string} key @param {boolean} [show] */
export function markChosen(list, key, show = false) {
  for (const row of /** @type {Iterable<HTMLElement>} */ (list.children)) {
    const chosen = row.dataset.key === key && key !== '';
    if (row.getAttribute('aria-selected') !== String(chosen)) row.setAttribute('aria-selected', String(chosen));
    if (!chosen) continue;
    list.setAttribute('aria-activedescendant', row.id);
    if (show) row.scrollIntoView({ block: 'nearest' });
  }
}
