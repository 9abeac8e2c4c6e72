// What this user has chosen to look at and to do; nothing of it leaves the page.
import { Signals } from './signals.js';

/** @typedef {'select' | 'move' | 'rotate' | 'align'} Tool */

/** @extends {Signals<{part: number, clash: number, tool: Tool, ghost: boolean, following: number, group: void}>} */
export class Choice extends Signals {
  part = 0;
  clash = 0;
  /** @type {Tool} */
  tool = 'select';
  ghost = false;
  following = 0;
  /** Parts that are taken in hand together. @type {Set<number>} */
  group = new Set();

  /** @param {number} part 0 none */
  choosePart(part) {
    if (part === this.part) return;
    this.part = part;
    this.emit('part', part);
  }

  /** Into the group or out of it. @param {number} part */
  gather(part) {
    if (!this.group.delete(part)) this.group.add(part);
    this.emit('group', undefined);
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
