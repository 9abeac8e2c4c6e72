// A live session with a browser before it: what the tests of one file share. Both end with those tests.
import { after } from 'node:test';
import { openBrowser, openPage } from './browser.mjs';
import { LiveSession } from './session.mjs';

export class BrowserSession extends LiveSession {
  /** @param {string} [name] */
  constructor(name) {
    super(name && `${name}${process.pid}`);
    after(() => this.end());
  }

  /** Opens the gateway and a browser. @param {string} [log] a recorded session; else the served one @param {string[]} [more] for the gateway @returns {Promise<BrowserSession>} */
  async show(log, more = []) {
    this.addresses = await this.open(log, '0', more);
    this.browser = await openBrowser();
    return this;
  }

  /** People who join, each at a page of their own; every other one in light colours. @param {string[]} names */
  async join(...names) {
    const pages = [];
    for (const name of names) {
      const scheme = pages.length % 2 ? 'light' : 'dark';
      pages.push(await openPage(this.browser, this.addresses.designer, { name, scheme }));
    }
    return pages;
  }

  async end() {
    await this.browser?.close();
    await super.end();
  }
}
