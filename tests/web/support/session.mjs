// A session as people have it: server, gateway, and bots where asked for, each a process of its own; ended by their ids.
import { execFile, spawn } from 'node:child_process';
import { createServer } from 'node:net';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';

const root = resolve(import.meta.dirname, '../../..');
const bin = process.env.MORTISE_BIN_DIR ?? join(root, 'build/release/bin');

/** Does a socket hold a UDP port of the domain still, say of a server that is being ended? @param {number} domain */
function hasPorts(domain) {
  const first = 7400 + 250 * domain;
  const ports = readFileSync('/proc/net/udp', 'utf8').match(/(?<=^ *\d+: [0-9A-F]{8}:)[0-9A-F]{4}/gm) ?? [];
  return ports.some((port) => parseInt(port, 16) >= first && parseInt(port, 16) < first + 250);
}

/** A DDS domain that no other test of this machine has: its name is taken as tests/network/domain.cpp takes it, until this process ends. */
async function takeDomain() {
  for (let tries = 0; ; ++tries) {
    const domain = 1 + ((process.pid + tries) % 100);
    const name = createServer().unref().listen(`\0mortise-test-domain-${domain}`);
    if (await new Promise((done) => name.once('listening', () => done(true)).once('error', () => done(false)))) {
      if (!hasPorts(domain)) return domain;
      name.close();
    }
  }
}

export class LiveSession {
  #children = [];
  folder = mkdtempSync(join(tmpdir(), 'mortise-web-'));
  domain = 0;

  /** @param {string} [name] */
  constructor(name = `web${process.pid}`) {
    this.name = name;
  }

  /** @param {string} program @param {string[]} args @param {(text: string) => unknown} [seen] of its output; truthy ends the waiting */
  async start(program, args, seen) {
    const child = spawn(join(bin, `mortise-${program}`), args, { cwd: root, stdio: ['ignore', 'pipe', 'pipe'] });
    child.text = '';
    this.#children.push(child);
    const ready = new Promise((done, fail) => {
      const take = (data) => {
        child.text += data;
        const found = seen?.(child.text);
        if (found) done(found);
      };
      child.stdout.on('data', take);
      child.stderr.on('data', take);
      child.once('error', fail);
      child.once('exit', (code) => fail(new Error(`mortise-${program} ended with ${code}:\n${child.text.slice(-2000)}`)));
      if (!seen) done(child);
    });
    ready.catch(() => {});
    child.ready = await ready;
    return child;
  }

  /** @param {string} scenario a file of scenarios/, or YAML @param {string[]} [more] */
  async serve(scenario, more = []) {
    const file = scenario.includes('\n') ? join(this.folder, 'scenario.yaml') : resolve(root, 'scenarios', scenario);
    if (scenario.includes('\n')) writeFileSync(file, scenario);
    this.domain ||= await takeDomain();
    this.server = await this.start('server', [file, '--session', this.name, '--domain', `${this.domain}`, ...more]);
  }

  /** Another server that stands by for the one that logs to the folder of this session; returns once it follows. @param {string[]} [more] */
  async standBy(more = []) {
    const logs = join(this.folder, 'logs');
    return this.start('server', ['--standby-of', this.name, '--restore', logs, '--log', logs, '--domain', `${this.domain}`, ...more], (text) => /standing by: (?!waiting)/.test(text));
  }

  /**
   * @param {string} [log] a recorded session, from the root of the project; else the running one
   * @param {string} [port] @param {string[]} [more] @returns the two addresses; their tokens stay the same
   */
  async open(log, port = '0', more = []) {
    const from = log ? ['--replay', join(root, log)] : ['--session', this.name, '--domain', `${this.domain}`];
    const args = [...from, '--http-port', port, '--page', join(root, 'client/web/page'), '--tokens', join(this.folder, 'tokens'), '--addresses', '-', ...more];
    this.gateway = await this.start('web', args, (text) => {
      const designer = /^designer (http\S+)$/m.exec(text);
      const observer = /^observer (http\S+)$/m.exec(text);
      return designer && observer && { designer: designer[1], observer: observer[1] };
    });
    return this.gateway.ready;
  }

  /** @param {string} play a file of scenarios/ @param {number} seconds @param {string[]} [more] */
  async play(play, seconds, more = []) {
    const args = ['--session', this.name, '--domain', `${this.domain}`, '--wait', '10', '--behaviour', 'script', '--play', join(root, 'scenarios', play), '--quiet', '--duration', `${seconds}`, ...more];
    return this.start('bot', args);
  }

  /** A program that ends by itself; what it printed. @param {string} program @param {string[]} args @returns {Promise<string>} */
  run(program, args) {
    return new Promise((done, fail) => {
      execFile(join(bin, `mortise-${program}`), args, { cwd: root }, (error, stdout, stderr) => (error ? fail(new Error(`${error.message}\n${stderr}`)) : done(stdout)));
    });
  }

  /** @param {import('node:child_process').ChildProcess} child */
  async stop(child) {
    child.removeAllListeners('exit');
    if (child.exitCode !== null || child.signalCode !== null) return;
    const gone = new Promise((done) => child.once('exit', done));
    child.kill('SIGINT');
    const late = setTimeout(() => child.kill('SIGKILL'), 4000);
    await gone;
    clearTimeout(late);
  }

  async end() {
    for (const child of this.#children.reverse()) await this.stop(child);
    rmSync(this.folder, { recursive: true, force: true });
  }
}
