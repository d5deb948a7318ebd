// What is drawn of each plant that is no tube: outlines, and what is warm, in the coordinates of a narrow screen. `fan` is a drawing of its own
// where nothing turns, `lanes` how many streaks of air there are, `solid` that no room air is in it.
const OVEN = "M16 98H352q10 0 10 10V172q0 10-10 10H16q-10 0-10-10V108q0-10 10-10z";
const HOTEND = "M76 104H262V117H290L352 138V146L290 166H262V176H76z";
const TCLAB = "M78 108H150V133H238V151H150V166H78zM262 108H300V133H330V151H300V166H262z";

export const PLANTS = {
  oven: {
    tube: [6, 362, 104, 176], warm: OVEN, lanes: 14,
    lines: [["wall", OVEN], ["thin", "M274 104V176"], ["wall", "M282 168H348"]],
  },
  hotend: {
    tube: [76, 352, 104, 176], warm: HOTEND, solid: true, lanes: 0,
    lines: [["wall", HOTEND], ["wall", "M262 117V166M290 117V166M271 117V166M281 117V166"]],
  },
  tclab: {
    tube: [78, 330, 104, 176], warm: TCLAB, solid: true, lanes: 0,
    lines: [["wall", TCLAB], ["board", "M70 166H360V180H70z"], ["wall", "M90 166V173M138 166V173M270 166V173M292 166V173"]],
    fan: "M16 126q9-9 18 0t18 0 18 0M16 142q9-9 18 0t18 0 18 0M16 158q9-9 18 0t18 0 18 0",
  },
};
