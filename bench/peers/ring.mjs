// The ring in XState: node ring.mjs STATES GUARDED WARM SECONDS
// Prints the events sent, those of them that were timed, their seconds, and the counter.
import { assign, createActor, createMachine } from "xstate";

const [states, guarded, warm, seconds] = process.argv.slice(2).map(Number);
const BATCH = 1_000;

const actions = assign({ n: ({ context }) => context.n + 1 });
const guards = [({ context }) => context.n < 0, ({ context }) => context.n < -1, ({ context }) => context.n >= 0];

function ring() {
  const made = {};
  for (let index = 0; index < states; index += 1) {
    const go = { target: `s${(index + 1) % states}`, actions };
    made[`s${index}`] = { on: { tick: guarded ? guards.map((guard) => ({ guard, ...go })) : go } };
  }
  return createMachine({ id: "ring", initial: "s0", context: { n: 0 }, states: made });
}

const actor = createActor(ring());
actor.start();

function tickFor(wanted) {
  const began = performance.now();
  let events = 0;
  let lasted = 0;
  while (lasted < wanted) {
    for (let tick = 0; tick < BATCH; tick += 1) actor.send({ type: "tick" });
    events += BATCH;
    lasted = (performance.now() - began) / 1000;
  }
  return [events, lasted];
}

const [before] = tickFor(warm);
const [timed, lasted] = tickFor(seconds);
const snapshot = actor.getSnapshot();
const state = Number(snapshot.value.slice(1));
console.log(JSON.stringify({ sent: before + timed, timed, lasted, count: snapshot.context.n, state }));
