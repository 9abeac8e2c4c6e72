// Views that this browser keeps, by session: a name, from where one looked, and at which clash.

/** @typedef {import('./motion.js').Vec3} Vec3 */
/** @typedef {{name: string, eye: Vec3, at: Vec3, clash: number}} SavedView */

const KEPT = 'mortise.views';
const MOST = 50;

/** @param {any} x */
const isPoint = (x) => Array.isArray(x) && x.length === 3 && x.every(Number.isFinite);

export class SavedViews {
  /** @param {Storage} storage */
  constructor(storage) {
    this.storage = storage;
  }

  /** What cannot be read is no view. @returns {Record<string, SavedView[]>} */
  #all() {
    try {
      const all = JSON.parse(this.storage.getItem(KEPT) ?? '{}');
      return typeof all === 'object' && all !== null ? all : {};
    } catch {
      return {};
    }
  }

  /** @param {string} session @returns {SavedView[]} */
  of(session) {
    const views = this.#all()[session];
    return Array.isArray(views) ? views.filter((view) => typeof view?.name === 'string' && isPoint(view.eye) && isPoint(view.at)) : [];
  }

  /** One of the same name is replaced; of too many the oldest goes. @param {string} session @param {SavedView} view */
  save(session, view) {
    const views = [...this.of(session).filter(({ name }) => name !== view.name), view].slice(-MOST);
    this.storage.setItem(KEPT, JSON.stringify({ ...this.#all(), [session]: views }));
  }

  /** @param {string} session @param {string} name */
  forget(session, name) {
    this.storage.setItem(KEPT, JSON.stringify({ ...this.#all(), [session]: this.of(session).filter((view) => view.name !== name) }));
  }
}
