// The steps of the tour: what to look at, what must be unfolded for it, and what a button does. Their words are those of the language. docs/tutorial.md goes deeper.
const fault = (part, last = 25) => ({ order: "break", fault: { ...part, at: 0, for: last } });
const T2_HIGH = fault({ do: "offset", sensor: "t2", size: 1.5 });
const T1_HIGH = fault({ do: "offset", sensor: "t1", size: 1.5 });
const CLOGGED = fault({ do: "clog", sensor: "t1", size: 0.85, lag: 0.4 });
const MORE_AIR = fault({ do: "air-flow", size: 1.26 }, 40);
const LESS_POWER = fault({ do: "heater-power", size: 0.75 }, 40);
const DRIFT = fault({ do: "drift", sensor: "t2", size: 4 }, 90);

export const STEPS = [
  { id: "tube", look: ".rig" },
  { id: "excitation", look: ".charts" },
  { id: "t2_lies", look: ".say", does: ["mend", T2_HIGH] },
  { id: "t1_lies", look: ".charts", does: ["mend", T1_HIGH] },
  { id: "residual", look: ".charts", opens: "charts" },
  { id: "signatures", look: ".charts", opens: "residuals", does: ["mend", T2_HIGH] },
  { id: "clogged", look: "aside", opens: "why", does: ["mend", CLOGGED] },
  { id: "more_air", look: ".charts", opens: "residuals", does: ["mend", MORE_AIR] },
  { id: "alike", look: ".say", does: ["mend", LESS_POWER] },
  { id: "slow", look: ".charts", opens: "charts", does: ["mend", DRIFT] },
  { id: "delay", look: ".say", opens: "desk" },
  { id: "safety", look: ".rig", does: ["mend", fault({ do: "open", sensor: "t1" }, 5)] },
  { id: "quiz", look: "#modes", does: ["surprise"] },
];
