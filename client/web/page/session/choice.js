// What this user has chosen to look at and to do; nothing of it leaves the page.
import { Signals } from './signals.js';

/** @typedef {'select' | 'move' | 'rotate' | 'align' | 'measure'} Tool */

/** @extends {Signals<{part: number, clash: number, tool: Tool, ghost: boolean, following: number, group: void, hidden: void, framed: void}>} */
export class Choice extends Signals {
  part = 0;
  clash = 0;
  /** @type {Tool} */
  tool = 'select';
  ghost = false;
  following = 0;
  /** Parts that are taken in hand together. @type {Set<number>} */
  group = new Set();
  /** Parts that are left out of the picture. @type {Set<number>} */
  hidden = new Set();

  /** @param {number} part 0 none */
  choosePart(part) {
    if (part === this.part) return;
    this.part = part;
    this.emit('part', part);
  }

  /** Into the group or out of it. The first one beside a chosen part makes a group of both. @param {number} part */
  gather(part) {
    if (!this.group.delete(part)) {
      if (this.group.size === 0 && this.part !== 0) this.group.add(this.part);
      this.group.add(part);
      if (this.part === 0) this.choosePart(part);
    }
    this.emit('group', undefined);
  }

  /** Nothing is gathered any more. */
  ungather() {
    this.group.clear();
    this.emit('group', undefined);
  }

  /** @param {Iterable<number>} parts */
  hide(parts) {
    for (const part of parts) this.hidden.add(part);
    this.emit('hidden', undefined);
  }

  /** Nothing but these is left in the picture. @param {number[]} shown @param {Iterable<number>} all */
  isolate(shown, all) {
    this.hidden = new Set([...all].filter((part) => !shown.includes(part)));
    this.emit('hidden', undefined);
  }

  showAll() {
    this.hidden.clear();
    this.emit('hidden', undefined);
  }

  /** The chosen part, and all of its group. @returns {number[]} */
  get together() {
    return this.group.has(this.part) ? [...this.group] : [this.part];
  }

  /** Also when it is chosen already: one flies there again. @param {number} clash 0 none */
  chooseClash(clash) {
    this.clash = clash;
    this.emit('clash', clash);
  }

  /** A scene is in the picture, and one looks at it. */
  framed() {
    this.emit('framed', undefined);
  }

  /** @param {Tool} tool */
  chooseTool(tool) {
    if (tool === this.tool) return;
    this.tool = tool;
    this.emit('tool', tool);
  }

  /** @param {boolean} on */
  setGhost(on) {
    if (on === this.ghost) return;
    this.ghost = on;
    this.emit('ghost', on);
  }

  /** @param {number} user 0 nobody */
  follow(user) {
    if (user === this.following) return;
    this.following = user;
    this.emit('following', user);
  }
}
