// Who wants to know is told, by name of what happened.

/** @template {Record<string, any>} Said */
export class Signals {
  /** @type {Map<keyof Said, Array<(what: any) => void>>} */
  #listeners = new Map();

  /** @template {keyof Said} Name @param {Name} name @param {(what: Said[Name]) => void} listener */
  on(name, listener) {
    const known = this.#listeners.get(name);
    if (known) known.push(listener);
    else this.#listeners.set(name, [listener]);
  }

  /** @template {keyof Said} Name @param {Name} name @param {Said[Name]} what */
  emit(name, what) {
    for (const listener of this.#listeners.get(name) ?? []) listener(what);
  }
}
