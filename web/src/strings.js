// The page's texts in English and Korean. What the run says comes in English; `korean.js` has it in Korean.
import { recall, remember, retell, Said } from "./dom.js";
import { inKorean } from "./korean.js";

const EN = {
  title: "trundle",
  live: "live", replay: "replay", report: "report",
  idle: "not started", running: "driving", paused: "paused", ended: "ended", offline: "no connection",
  waiting: "waiting", waitsGoal: "waiting for the next goal",
  connecting: "Connecting…",
  reconnecting: "Connection lost. Trying again in {s} s.",
  noscene: "Loading the world…",
  nowebgl: "This browser has no WebGL, so the 3D view is off. The map shows everything that can be set and steered.",
  scene: "3D view. Drag turns it, the wheel zooms.", map: "Map. Arrow keys move it, plus and minus zoom.",
  mapKeys: "Arrow keys move the cross, Q and E turn it, Enter sets it, Escape cancels.",
  orbit: "Orbit", follow: "Follow", top: "Top", cameras: "Camera",
  fit: "Fit", zoomIn: "Zoom in", zoomOut: "Zoom out", layers: "Layers",
  pause: "Pause", resume: "Resume", step: "Step", speed: "Speed", max: "max", real: "real × {x}",
  goal: "Set goal", start: "Set start", queue: "Queue", restart: "Restart", next: "Next seed", box: "Drop box",
  stop: "End run", stick: "Stick", drive: "Drive by hand",
  pauseHint: "Pause or go on (Space)", stepHint: "Drive one control period (N)", goalHint: "Set a goal: click the floor or the map (G)",
  queueHint: "Put the next goals behind those that are left", boxHint: "Drop a box where you click (B)",
  restartHint: "Start the run again with the same seed", nextHint: "Start the run again with the next seed", stopHint: "End the run and set up another one",
  hintGoal: "Click the floor or the map; drag to set the heading.", hintStart: "Click where the robot starts; drag to set its heading.",
  hintBox: "Click where the box should fall.", hintPose: "Click where the robot is; drag to set its heading.",
  setPose: "Set pose", findPose: "Find pose",
  setPoseHint: "Tell the robot where it is: press on the map, drag for the heading (P)", findPoseHint: "Let the robot search the whole map for its pose",
  position: "Position", localized: "localized", ambiguous: "ambiguous", ambiguousOf: "ambiguous: {n} places", lost: "lost", offBy: "Estimate off by",
  keys: "W A S D or arrows drive · Space pauses · G goal · N step",
  youDrive: "You drive", youWatch: "Watching", ask: "Ask to drive", asked: "Asked…", watchers: "{n} watching",
  asks: "Page {id} asks to drive.", grant: "Hand over", refuse: "Refuse", noDriver: "Nobody drives", take: "Drive",
  world: "World", robot: "Robot", planner: "Planner", controller: "Controller", seed: "Seed", go: "Go",
  newRun: "New run", choose: "Choose a start and a goal on the map, or leave them to the seed.",
  startAt: "Start", goalAt: "Goal", auto: "by seed", auto0: "as given", clear: "Clear",
  status: "Status", events: "Events", plots: "Plots", figures: "Figures",
  time: "Time", speedNow: "Speed", turning: "Turning", clearance: "Clearance", crossTrack: "Cross-track",
  planning: "Planning", tick: "Control tick", goalNow: "Goal", doing: "Doing",
  commanded: "commanded", measured: "measured", heldBack: "Held back: {why}", manualBy: "Page {id} drives by hand",
  arrived: "arrived", folder: "Run folder", openReplay: "Open the replay",
  play: "Play", playPause: "Play or pause", seek: "Time in the run", pace: "Pace",
  verdict: "Verdict", contacts: "What the robot touched", noContacts: "It touched nothing.", settings: "Settings",
  versions: "Versions", repeat: "Repeat this run", copy: "Copy", copied: "Copied", plans: "Plans", events_: "Events",
  theme: "Light or dark", language: "한국어",
  l_map: "map", l_costmap: "costmap", l_solids: "world", l_path: "path", l_trail: "trail", l_scan: "lidar",
  l_footprint: "footprint", l_clearance: "clearance", l_goals: "goals", l_movers: "movers", l_tracks: "tracks",
  l_rollouts: "rollouts", l_contacts: "contacts", l_estimate: "estimate", l_particles: "particles", l_graph: "poses and loops",
  what: "what", when: "time", where: "where", distance: "distance", points: "points", length: "length",
  view: "live", keysHeld: "Keys held", viewKeys: "Keys go to the program · G goal",
};

const KO = {
  title: "trundle",
  live: "실시간", replay: "재생", report: "보고서",
  idle: "시작 전", running: "주행 중", paused: "일시 정지", ended: "끝남", offline: "연결 없음",
  waiting: "대기 중", waitsGoal: "다음 목표를 기다립니다",
  connecting: "연결하는 중…",
  reconnecting: "연결이 끊겼습니다. {s}초 뒤에 다시 연결합니다.",
  noscene: "월드를 불러오는 중…",
  nowebgl: "이 브라우저에는 WebGL이 없어 3D 화면을 끕니다. 지도에서 모두 볼 수 있고 조종할 수 있습니다.",
  scene: "3D 화면. 끌면 돌고 휠로 확대합니다.", map: "지도. 화살표 키로 움직이고 +, -로 확대합니다.",
  mapKeys: "화살표 키로 십자를 옮기고 Q, E로 돌린 뒤 Enter로 정합니다. Escape는 취소입니다.",
  orbit: "둘러보기", follow: "따라가기", top: "위에서", cameras: "카메라",
  fit: "맞춤", zoomIn: "확대", zoomOut: "축소", layers: "레이어",
  pause: "일시 정지", resume: "계속", step: "한 주기", speed: "속도", max: "최대", real: "실제 × {x}",
  goal: "목표 지정", start: "출발점 지정", queue: "이어 넣기", restart: "다시 시작", next: "다음 시드", box: "상자 놓기",
  stop: "끝내기", stick: "스틱", drive: "직접 조종",
  pauseHint: "멈추거나 계속합니다 (Space)", stepHint: "제어 주기 하나만 주행합니다 (N)", goalHint: "목표 지정: 바닥이나 지도를 누릅니다 (G)",
  queueHint: "다음 목표를 남은 목표 뒤에 넣습니다", boxHint: "누르는 곳에 상자를 놓습니다 (B)",
  restartHint: "같은 시드로 다시 시작합니다", nextHint: "다음 시드로 다시 시작합니다", stopHint: "주행을 끝내고 새 주행을 준비합니다",
  hintGoal: "바닥이나 지도를 누르세요. 끌면 방향이 정해집니다.", hintStart: "로봇이 출발할 곳을 누르세요. 끌면 방향이 정해집니다.",
  hintBox: "상자를 놓을 곳을 누르세요.", hintPose: "로봇이 있는 곳을 누르세요. 끌면 방향이 정해집니다.",
  setPose: "위치 알려주기", findPose: "위치 찾기",
  setPoseHint: "로봇이 있는 곳을 알려 줍니다: 지도를 누르고 끌어 방향을 정합니다 (P)", findPoseHint: "로봇이 지도 전체에서 제 위치를 찾게 합니다",
  position: "위치", localized: "확인됨", ambiguous: "불확실", ambiguousOf: "불확실: 후보 {n}곳", lost: "잃음", offBy: "추정 오차",
  keys: "W A S D·화살표 조종 · Space 일시 정지 · G 목표 · N 한 주기",
  youDrive: "내가 조종", youWatch: "보는 중", ask: "조종 요청", asked: "요청함…", watchers: "{n}명 보는 중",
  asks: "페이지 {id}에서 조종을 요청합니다.", grant: "넘기기", refuse: "거절", noDriver: "조종자 없음", take: "조종하기",
  world: "월드", robot: "로봇", planner: "플래너", controller: "컨트롤러", seed: "시드", go: "출발",
  newRun: "새 주행", choose: "지도에서 출발점과 목표를 고르거나 시드에 맡기세요.",
  startAt: "출발점", goalAt: "목표", auto: "시드에 따라", auto0: "주어진 대로", clear: "지우기",
  status: "상태", events: "이벤트", plots: "그래프", figures: "수치",
  time: "시간", speedNow: "속도", turning: "회전", clearance: "여유 거리", crossTrack: "경로 이탈",
  planning: "경로 계획", tick: "제어 주기", goalNow: "목표", doing: "동작",
  commanded: "명령", measured: "측정", heldBack: "막힘: {why}", manualBy: "페이지 {id}에서 직접 조종",
  arrived: "도착", folder: "주행 폴더", openReplay: "재생 열기",
  play: "재생", playPause: "재생 또는 정지", seek: "주행 시각", pace: "배속",
  verdict: "판정", contacts: "로봇이 닿은 것", noContacts: "아무것에도 닿지 않았습니다.", settings: "설정",
  versions: "버전", repeat: "이 주행 반복", copy: "복사", copied: "복사함", plans: "계획한 경로", events_: "이벤트",
  theme: "밝게 또는 어둡게", language: "English",
  l_map: "지도", l_costmap: "코스트맵", l_solids: "월드", l_path: "경로", l_trail: "자취", l_scan: "라이다",
  l_footprint: "풋프린트", l_clearance: "여유 거리", l_goals: "목표", l_movers: "이동체", l_tracks: "추적",
  l_rollouts: "롤아웃", l_contacts: "접촉", l_estimate: "추정 위치", l_particles: "파티클", l_graph: "자세와 루프",
  what: "대상", when: "시각", where: "위치", distance: "거리", points: "점", length: "길이",
  view: "실시간", keysHeld: "누르고 있는 키", viewKeys: "키 입력은 프로그램으로 갑니다 · G 목표",
};

let table = EN;

export function startLanguage(fallback) {
  const chosen = recall("lang") ?? /lang=(\w+)/.exec(location.hash)?.[1] ?? fallback ?? navigator.language;
  table = chosen?.startsWith("ko") ? KO : EN;
  document.documentElement.lang = table === KO ? "ko" : "en";
}

const listeners = [];
export const onLanguage = (listener) => listeners.push(listener);

/** Shows the page in the other language; nothing else of it changes. */
export function switchLanguage() {
  table = table === KO ? EN : KO;
  remember("lang", table === KO ? "ko" : "en");
  document.documentElement.lang = table === KO ? "ko" : "en";
  retell(document.body);
  for (const listener of listeners) listener();
}

export function t(key, values = {}) {
  return (table[key] ?? EN[key] ?? key).replace(/\{(\w+)\}/g, (_, name) => values[name] ?? "");
}

/** What `t` returns, in the language that is shown. */
export const say = (key, values) => saying(() => t(key, values));
export const saying = (read) => new Said(read);

/** What the run says, in the language that is shown; in English where there is no translation. */
export const told = (text) => (table === KO ? inKorean(text) : text);

/** How a run ended, in words: the outcome, unless its message begins with it, and the message. */
export function toldEnd({ outcome, message }) {
  const name = outcome.replaceAll("_", " ");
  return told(!message ? name : message.startsWith(name) ? message : `${name}: ${message}`);
}
