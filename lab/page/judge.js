// What a student enters to a question of an exercise, judged: against the true value, or by what was chosen.

// A number as people type it; NaN where it is none.
export const typed = (text) => (text.trim() ? Number(text.trim().replace(",", ".").replace("−", "-")) : NaN);

// Whether it is right, and what is to be told of it, in both languages. Null where nothing was entered that could be judged.
export function judge(ask, entered) {
  if (ask.choices) {
    const choice = ask.choices[entered];
    return choice ? { right: !!choice.right, say: choice.say } : null;
  }
  const x = typed(entered ?? "");
  if (!Number.isFinite(x)) return null;
  const by = parseFloat(ask.within);
  const near = (value) => Math.abs(x - value) <= (ask.within.endsWith("%") ? Math.abs(value) * by * 0.01 : by) * (1 + 1e-9);
  if (near(ask.answer)) return { right: true };
  return { right: false, say: ask.wrong?.find(({ answer }) => near(answer))?.say };
}
