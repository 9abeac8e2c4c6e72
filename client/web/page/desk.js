// Puts the page together: what is known, what is shown, what is asked. Each panel takes from the desk what it needs.
import { Connection, tokenOf } from './session/connection.js';
import { Choice } from './session/choice.js';
import { Commands } from './session/commands.js';
import { forgetToken, keptToken } from './session/link.js';
import { readPoseFrame } from './session/frames.js';
import { Mover } from './session/mover.js';
import { Session } from './session/session.js';
import { Uploads } from './session/uploads.js';
import { Stops } from './session/stops.js';
import { Stage } from './view/stage.js';
import { Ground } from './view/ground.js';
import { Camera } from './view/camera.js';
import { ClashMarks } from './view/clash_marks.js';
import { Handles } from './view/handles.js';
import { Heat } from './view/heat.js';
import { Labels } from './view/labels.js';
import { PartsView } from './view/parts_view.js';
import { WayGhost } from './view/way_ghost.js';
import { SectionPlane } from './view/section_plane.js';
import { makeFlights } from './view/flights.js';
import { byId } from './panels/dom.js';
import { say } from './panels/said.js';

/**
 * The line to the gateway as people see it.
 * @typedef {{state: import('./session/connection.js').LineState, told: import('./session/connection.js').LineTold, roundTrip: number, frames: number, onChange: () => void}} Line
 */

export function makeDesk() {
  const session = new Session();
  const choice = new Choice();
  /** @type {Line} */
  const line = { state: 'connecting', told: { trouble: '', why: '', retryAt: 0 }, roundTrip: 0, frames: 0, onChange: () => {} };
  const connection = new Connection(keptToken(tokenOf(location.hash), localStorage), {
    message: (message) => (message.type === 'reply' ? commands.take(message) : session.apply(message)),
    poses: (buffer) => {
      const frame = readPoseFrame(buffer);
      if (!frame) return;
      ++line.frames;
      session.applyPoses(frame);
    },
    roundTrip: (ms) => (line.roundTrip = ms),
    state: (state, told) => {
      if (line.state === 'open' && state !== 'open') {
        session.lost();
        commands.lost();
        uploads.lost();
        mover.dropAll();
      }
      if (told.trouble === 'token') forgetToken(connection.token, localStorage);
      Object.assign(line, { state, told });
      line.onChange();
    },
  });
  const send = (/** @type {object} */ message) => connection.send(message);
  const commands = new Commands(send, say);
  const uploads = new Uploads(send, (path, file) => connection.post(path, file));
  const stops = new Stops();
  const mover = new Mover((part, increment) => {
    const known = session.parts.get(part);
    const sent = send({ type: 'move', part, ...increment });
    if (known && sent) stops.asked(known, increment, performance.now());
    return sent;
  });

  const stage = new Stage(/** @type {HTMLCanvasElement} */ (byId('canvas')));
  const partsView = new PartsView(stage, (hash) => connection.mesh(hash), (text) => say(text, 'bad'));
  const ground = new Ground(stage, partsView);
  const camera = new Camera(stage, (view) => line.state === 'open' && send({ type: 'view', ...view }));
  const marks = new ClashMarks(stage);
  const way = new WayGhost(stage, partsView);
  const heat = new Heat(stage, partsView, session);
  const section = new SectionPlane(partsView);
  const handles = new Handles(stage, camera, (part, increment) => mover.push(part.id, increment));
  const labels = new Labels(stage, session, partsView, byId('labels'));
  labels.sources.push(() => marks.notes, () => way.notes);
  const flights = makeFlights({ session, choice, camera, partsView, section });
  return { session, choice, line, connection, send, commands, uploads, mover, stops, stage, partsView, ground, camera, marks, way, heat, section, handles, labels, say, ...flights };
}

/** @typedef {ReturnType<typeof makeDesk>} Desk */
