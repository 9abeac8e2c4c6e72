// The page begins here.
import { makeDesk } from './desk.js';
import { makeAddParts } from './panels/add_parts.js';
import { makeAlign } from './panels/align.js';
import { makeArrival } from './panels/arrive.js';
import { makeArriving } from './panels/arriving.js';
import { makeAsks } from './panels/asks.js';
import { makeClashDetail } from './panels/clash_detail.js';
import { makeClashList } from './panels/clash_list.js';
import { makeHeatLegend } from './panels/heat_legend.js';
import { makeHand } from './panels/hand.js';
import { makeJoin } from './panels/join.js';
import { makeKeyboard } from './panels/keyboard.js';
import { makeMeasure } from './panels/measure.js';
import { makeNews } from './panels/news.js';
import { makePeople } from './panels/people.js';
import { makePlaces } from './panels/places.js';
import { makeProposedRules } from './panels/proposed_rules.js';
import { makeReport } from './panels/report.js';
import { makeRules } from './panels/rules.js';
import { makeSectionBar } from './panels/section_bar.js';
import { makeSpaceMouse } from './panels/space_mouse.js';
import { makeStatistics } from './panels/statistics.js';
import { makeStatus } from './panels/status.js';
import { makeTheme } from './panels/theme.js';
import { makeTimeline } from './panels/timeline.js';
import { makeToolbar } from './panels/toolbar.js';
import { makeTree } from './panels/tree.js';
import { makeUnexaminedList } from './panels/unexamined_list.js';
import { makeViews } from './panels/views.js';
import { byId } from './panels/dom.js';
import { drawCompass } from './view/compass.js';
import { makeFaceHover } from './view/face_hover.js';
import { followSession } from './view/follow_session.js';
import { makePartDrag } from './view/part_drag.js';
import { makePointer } from './view/pointer.js';

makeTheme();
const desk = makeDesk();
const { session, choice, camera, section } = desk;
makeStatus(desk);
followSession(desk);
drawCompass(desk.stage, /** @type {HTMLCanvasElement} */ (byId('compass')), (side) => desk.showAll(side));
makeTree(desk);
const arriving = makeArriving();
makeAddParts(desk, arriving);
makePeople(desk);
makeAsks(desk);
makePlaces(desk);
makeArrival(desk);
makeViews(desk);
makeClashList(desk);
makeUnexaminedList(desk);
makeClashDetail(desk);
makeHeatLegend(desk);
const rules = [makeRules(desk), makeProposedRules(desk)];
makeStatistics(desk, () => rules.forEach(({ refresh }) => refresh()));
makeNews(desk);
makeReport(desk);
makeSectionBar(section, () => session.emit('clashes', undefined));
const toolbar = makeToolbar(desk);
const hand = makeHand(desk, arriving);
const timeline = makeTimeline(desk);
const join = makeJoin(session, desk.send);
const tools = [makeAlign(desk), makeMeasure(desk)];
makePartDrag(desk);
makeFaceHover(desk);
makePointer(desk, (part, hit) => tools.some(({ pick }) => pick(part, hit)));
makeKeyboard({
  grab: hand.toggle, gather: () => choice.part && choice.gather(choice.part), step: hand.stepBy, stepSize: hand.changeStep, tool: toolbar.chooseTool, section: toolbar.toggleSection, cancel: toolbar.cancel,
  undo: () => toolbar.change('undo'), redo: () => toolbar.change('redo'), ghost: () => choice.setGhost(!choice.ghost), ground: toolbar.toggleGround, hide: toolbar.hide, isolate: toolbar.isolate, unhide: () => choice.showAll(), picture: toolbar.takePicture, play: timeline.toggle,
  fit: () => desk.showAll(), part: () => desk.showPart(choice.part), from: (side) => desk.showAll(side),
  turnView: (right, up) => camera.turn(right, up), closer: (times) => camera.closer(times),
  nextClash: () => desk.goClash(1), lastClash: () => desk.goClash(-1),
});
makeSpaceMouse(desk);
byId('line_state').onclick = join.ask;
session.on('join_refused', (text) => join.refused(text));
session.on('welcome', () => join.welcome());
desk.connection.open();
