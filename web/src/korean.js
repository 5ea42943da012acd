// What the run says in Korean: its status, its outcome and its events, which come in English.

// The words of parts that are said on their own, and of what follows "; " or ": ".
const WORDS = {
  "driving to the goal": "목표로 주행 중", driving: "주행 중", planning: "경로 계획", idle: "목표 없음", blocked: "막힘", behaving: "동작 실행 중",
  arrived: "도착", "arrived by estimate": "추정 위치로는 도착", finished: "완료", succeeded: "성공", success: "성공", reached: "도착",
  collided: "충돌", stuck: "갇힘", "timed out": "시간 초과", "no path": "경로 없음", "planning timed out": "경로 계획 시간 초과",
  aborted: "중단", error: "오류", failed: "실패", interrupted: "중단", none: "없음",
  "slowed by the collision monitor": "충돌 감시기가 감속시킴",
  "slowed by the collision monitor, which sees something ahead": "앞에 무언가 있어 충돌 감시기가 감속시킴",
  "stopped by the collision monitor": "충돌 감시기가 정지시킴",
  "the collision monitor stops the robot": "충돌 감시기가 로봇을 정지시킴",
  "the collision monitor slows the robot": "충돌 감시기가 로봇을 감속시킴",
  "the collision monitor": "충돌 감시기", stop: "정지", slow: "감속", approach: "접근 감속",
  "driven by hand": "직접 조종 시작", "driven by the navigator again": "내비게이터가 다시 주행", "no goal": "목표 없음",
  "asked for": "요청됨", "no progress": "진행 없음", "no progress along the path": "경로를 따라 나아가지 못함",
  "no valid control": "낼 수 있는 명령 없음", "blocked by a mover": "이동체에 막힘", "goal occupied": "목표에 장애물이 있음",
  "waiting to plan": "경로 계획을 기다림", "no path yet": "아직 경로 없음", "the path is blocked": "경로가 막힘",
  "the outline would touch something": "로봇이 무언가에 닿게 됨", "standing is the best sample": "서 있는 것이 가장 나은 후보",
  "planning a new path": "새 경로 계획", "it left the path that it was given": "주어진 경로를 벗어남",
  "the goal is reached": "목표에 도착", "there is another goal": "다른 목표를 받음", cancelled: "취소됨",
  "it would touch something": "무언가에 닿게 됨", "ended to start again": "다시 시작하려고 끝냄", "ended by hand": "직접 끝냄",
  "stopped by Ctrl-C": "Ctrl-C로 멈춤", "no path to the goal was found": "목표까지 경로가 없음", "ended from outside": "밖에서 끝냄",
  "an obstacle of the costmap": "코스트맵의 장애물",
  "they are separated by occupied or unknown space": "막히거나 모르는 공간으로 나뉨",
  "goals reached": "도착한 목표", planned: "계획한 경로", "mean cross-track error": "평균 경로 이탈", "largest cross-track error": "최대 경로 이탈",
  "turning per distance": "거리당 회전", "steps of recovery": "복구 동작", "stops by the collision monitor": "충돌 감시기의 정지",
  "error of the estimate": "추정 오차", "mean error of the estimate": "평균 추정 오차",
  "error of the estimate, 95 % of the run": "추정 오차 (주행의 95 %)", "not localized": "위치를 모른 시간",
  "search for a path": "경로 탐색", "run into while standing by": "서 있는 로봇에 부딪힌 것",
  "touched, but seen by no lidar": "닿았지만 라이다에 안 보인 것",
  "the robot does not know where it is": "로봇이 제 위치를 모름", "looking around": "주변을 둘러보는 중",
  "the robot is not sure where": "로봇의 위치가 확실하지 않음",
  localized: "위치 확인됨", ambiguous: "위치 불확실", lost: "위치를 잃음",
  time: "시간", distance: "주행 거리", "smallest clearance": "최소 여유 거리",
  "real-time factor": "실시간 배율", replans: "다시 계획",
};

const N = "([-\\d.,]+)";
const AT = `\\(${N}, ${N}(?:, ${N})?\\)`;
// Whole sentences; "@1" is a part that is said in Korean itself.
const SENTENCES = [
  [`arrived after ${N} s`, "$1초 만에 도착"],
  [`arrived by its estimate after ${N} s, which is ${N} m from where the robot is`, "$1초 만에 추정 위치로 도착, 실제 위치와 $2 m 차이"],
  [`finished after ${N} s`, "$1초 만에 완료"],
  ["ended by page (\\d+)", "페이지 $1에서 끝냄"],
  [`(?:goal|goals) not reached within ${N} s`, "$1초 안에 목표에 도착하지 못함"],
  [`not finished within ${N} s`, "$1초 안에 끝내지 못함"],
  [`stuck at ${AT} after ${N} s: (.+)`, "$4초 뒤 ($1, $2)에서 갇힘: @5"],
  [`stuck at ${AT} after ${N} s`, "$4초 뒤 ($1, $2)에서 갇힘"],
  [`stuck at ${AT}: (.+)`, "($1, $2)에서 갇힘: @4"],
  [`tipped over by (.+) at ${AT} after ${N} s`, "$5초 뒤 ($2, $3)에서 $1 넘어짐"],
  [`planning timed out at ${AT}: (.+)`, "($1, $2)에서 경로 계획 시간 초과: @4"],
  [`(?:the )?(.+) touches (.+) at ${AT} after ${N} s`, "$6초 뒤 ($3, $4)에서 $1 부분이 $2에 닿음"],
  [`(?:the )?(.+) touches (.+) at ${AT}`, "($3, $4)에서 $1 부분이 $2에 닿음"],
  ["touched (.+) while driving", "주행 중 $1에 닿음"],
  [`the (?:navigator|agent) says that it arrived, but it is at ${AT}`, "도착했다고 하지만 로봇은 ($1, $2)에 있음"],
  ["the simulator failed: (.+)", "시뮬레이터 오류: $1"],
  [`(\\S+) at ${AT}, goal (.+)`, "$1, 출발 ($2, $3), 목표 $5"],
  [`(\\S+) at ${AT}`, "$1, 출발 ($2, $3)"],
  ["goal (\\d+) of (\\d+) reached", "목표 $1/$2 도착"],
  ["goal (\\d+) reached", "목표 $1 도착"],
  ["goal set: (.+)", "목표 지정: $1"],
  ["task of goal (\\d+)", "목표 $1의 작업"],
  [`path of ${N} m`, "경로 $1 m"],
  [`another path of ${N} m`, "새 경로 $1 m"],
  ["held back: (.+)", "막힘: @1"],
  [`blocked: obstacle ahead at ${AT}`, "막힘: 앞 ($1, $2)에 장애물"],
  [`obstacle ahead at ${AT}`, "앞 ($1, $2)에 장애물"],
  [`blocked at ${AT}: (.+)`, "($1, $2)에서 막힘: @4"],
  [`stopped at ${AT} by the collision monitor: (.+)`, "($1, $2)에서 충돌 감시기가 정지시킴: @4"],
  [`the estimate was corrected by ${N} m and ${N}° at ${AT}`, "추정 위치가 ($3, $4)에서 $1 m, $2° 보정됨"],
  [`the pose jumped by ${N} m: (.+)`, "위치가 $1 m 튐: @2"],
  [`it took longer than ${N} s`, "$1초보다 오래 걸림"],
  ["([a-z_]+) (succeeded|failed|interrupted): (.+)", "$1 @2: @3"],
  ["([a-z_]+) (succeeded|failed|interrupted)", "$1 @2"],
  [`(?:the )?(goal|start) ${AT} lies outside the map(.*)`, "@1 ($2, $3)가 지도 밖임"],
  [`(?:the )?(goal|start) ${AT} lies in (.+)`, "@1 ($2, $3)에 설 수 없음: $5"],
  [`(?:the )?(goal|start) ${AT} is occupied by something that is not on the map(.*)`, "@1 ($2, $3)에 지도에 없는 것이 있음"],
  [`no path from ${AT} to ${AT}: (.+)`, "($1, $2)에서 ($4, $5)까지 경로 없음: @7"],
  ["the robot is at one of (\\d+) places: (.+)", "후보 $1곳 중 한 곳에 있음: @2"],
  ["ambiguous: (\\d+) places", "위치 불확실: 후보 $1곳"],
  ["goal (\\d+): (.+)", "목표 $1: @2"],
].map(([pattern, korean]) => [new RegExp(`^${pattern}$`), korean]);
const ENDS = { goal: "목표", start: "출발점" };

/** A text of the run in Korean; parts that are not known stay as they are. */
export function inKorean(text) {
  if (WORDS[text] ?? ENDS[text]) return WORDS[text] ?? ENDS[text];
  for (const [pattern, korean] of SENTENCES) {
    const found = pattern.exec(text);
    if (found) return korean.replace(/([@$])(\d)/g, (_, kind, n) => (kind === "@" ? inKorean(found[n] ?? "") : (found[n] ?? "")));
  }
  for (const mark of ["; ", ": "]) {
    const at = text.indexOf(mark);
    if (at > 0) return inKorean(text.slice(0, at)) + mark + inKorean(text.slice(at + mark.length));
  }
  return text;
}
