// A gateway without a session: serves the page and a scene of parts that all move at once. For measuring the page alone.
import { createReadStream, existsSync, statSync } from 'node:fs';
import { createServer } from 'node:http';
import { extname, join, resolve } from 'node:path';
import { WebSocketServer } from 'ws';
import { meshBytes, poseFrame } from './frames.mjs';

const folder = resolve(import.meta.dirname, '../../../client/web/page');
const TYPES = { '.html': 'text/html', '.js': 'text/javascript', '.css': 'text/css', '.svg': 'image/svg+xml' };

/** A toothed disc: 12 triangles a tooth. @param {number} teeth */
function disc(teeth) {
  const points = [0, 0, -4, 0, 0, 4];
  const triangles = [];
  const rim = 2 * teeth;
  for (let i = 0; i < rim; ++i) {
    const angle = (Math.PI * i) / teeth;
    const radius = i % 2 ? 9 : 7.5;
    for (const z of [-4, 4]) points.push(radius * Math.cos(angle), radius * Math.sin(angle), z);
  }
  for (let i = 0; i < rim; ++i) {
    const [a, b] = [2 + 2 * i, 2 + 2 * ((i + 1) % rim)];
    triangles.push(0, b, a, 1, a + 1, b + 1, a, b, b + 1, a, b + 1, a + 1);
  }
  return meshBytes(points, triangles);
}

/** @param {number} count of parts @param {number} shapes among them @param {number} held by somebody */
export async function openFakeGateway(count, shapes, held) {
  const meshes = Array.from({ length: shapes }, (_, i) => disc(12 + 6 * (i % 20))); // no larger where there are more
  const side = Math.ceil(Math.sqrt(count));
  const parts = Array.from({ length: count }, (_, i) => ({
    id: i + 1, name: `part_${i + 1}`, mesh: `shape${i % shapes}`, moving: true, holder: i < held ? 2 : 0, radius: 10, reference: [0, 0, 0], features: [], classes: 0,
    p: [25 * (i % side), 25 * Math.floor(i / side), 0], q: [0, 0, 0, 1],
  }));
  const server = createServer((request, response) => {
    const path = new URL(request.url, 'http://x').pathname;
    const mesh = /^\/mesh\/shape(\d+)\.bin$/.exec(path);
    if (mesh) {
      response.end(Buffer.from(meshes[Number(mesh[1])]));
      return;
    }
    const file = path.startsWith('/three/') ? join(folder, 'node_modules', path) : join(folder, path === '/' ? 'index.html' : path);
    if (!existsSync(file) || !statSync(file).isFile()) {
      response.writeHead(404).end();
      return;
    }
    response.writeHead(200, { 'Content-Type': TYPES[extname(file)] ?? 'application/octet-stream' });
    createReadStream(file).pipe(response);
  });
  const sockets = new WebSocketServer({ server, path: '/ws', handleProtocols: () => 'mortise.1' });
  sockets.on('connection', (socket) => {
    const tell = (message) => socket.send(JSON.stringify(message));
    tell({ type: 'welcome', protocol: 1, mode: 'live', role: 'observer', limits: {} });
    tell({ type: 'scene', session: 'fake', tick: 0, tick_rate_hz: 60, policy: 'stop', parts, users: [{ id: 2, name: 'somebody', present: true, role: 'designer' }], clashes: [], standing: [] });
    let tick = 0;
    const beat = setInterval(() => {
      if (socket.bufferedAmount > 1e5) return; // as a gateway would: the latest wins
      ++tick;
      const poses = parts.map(({ id, holder, p }, i) => {
        const angle = 0.02 * tick + i;
        return { part: id, holder, p: [p[0], p[1], 6 * Math.sin(angle)], q: [0, 0, Math.sin(angle / 2), Math.cos(angle / 2)], classes: i % 40 === 0 ? 2 : 0 };
      });
      socket.send(Buffer.from(poseFrame(tick, poses)));
    }, 1000 / 60);
    socket.on('close', () => clearInterval(beat));
  });
  await new Promise((done) => server.listen(0, '127.0.0.1', done));
  const { port } = /** @type {any} */ (server.address());
  return {
    address: `http://127.0.0.1:${port}/#token=measuring`,
    close: () => {
      sockets.clients.forEach((socket) => socket.terminate());
      sockets.close();
      server.close();
    },
  };
}
