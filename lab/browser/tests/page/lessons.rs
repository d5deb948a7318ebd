//! What leads through the page: the quiz and the tour.

use serde_json::{Value, json};

use crate::on_page;

#[test]
fn the_quiz_hides_the_name_until_it_is_answered_and_keeps_the_score() {
    let [hidden, told] = serde_json::from_value::<[Value; 2]>(on_page(
        r##"
        await monitoring();
        click("[data-mode=quiz]");
        await until(() => $("[data-act=quiz-start]"));
        const before = { ...lab.quiz.score };
        click("[data-act=quiz-start]");
        lab.send({ command: "run", speed: 0 });
        while (lab.quiz.phase !== "ask") await step(5);
        await step(60);
        await until(() => $(".answers"));
        click("[data-part=T1]");
        const hidden = [$("#head").innerText, $("#why").hidden, $("#events").innerText, !!$(".part.blamed"), $("#hint").innerText, document.body.innerText.includes(lab.quiz.event.label()), $("#sheet").hidden, lab.quiz.score.it - before.it];
        click(`[data-name=${lab.quiz.right}]`);
        await until(() => !$(".answers"));
        return [hidden, [$("#head").innerText.slice(0, 6), lab.quiz.score.you - before.you, lab.quiz.score.it - before.it, $("#why").hidden]];"##,
        &[],
    ))
    .expect("two lists");
    let head = hidden[0].as_str().expect("text");
    assert!(head.starts_with("Something broke"), "{head}");
    assert_eq!(
        hidden.as_array().map(|all| &all[1..]),
        json!([true, "\tNothing has happened yet.", false, "", false, true, 1])
            .as_array()
            .map(|all| &all[..])
    );
    assert_eq!(told, json!(["Right:", 1, 1, false]));
}

/// Every step of the tour has its words in both languages, looks at something, and its button does something.
#[test]
fn the_tour_goes_to_its_end() {
    let steps = on_page(
        r##"await monitoring();
           click("[data-mode=tour]");
           const steps = [];
           for (;;) {
             const does = $("[data-do]");
             const before = lab.events().orders.length + lab.quiz.phase;
             if (does) { does.click(); await step(120); }
             const done = !does || lab.events().orders.length + lab.quiz.phase !== before || lab.events().list.length > 0;
             const english = $("#tour .text").textContent;
             const words = $("#tour h2").textContent.length > 5 && $("#tour .text").textContent.length > 100;
             click("#language");
             const other = lab.lab.mode !== "tour" || $("#tour .text").textContent.length > 100 && $("#tour .text").textContent !== english;
             click("#language");
             const looked = document.querySelector(".looked");
             await until(() => !looked || looked.getBoundingClientRect().top < innerHeight / 2);
             steps.push([!!looked || lab.lab.mode !== "tour", done, words, other]);
             if (lab.lab.mode !== "tour" || $("[data-step='1']").disabled) return steps;
             click("[data-step='1']");
           }"##,
        &[],
    );
    let steps: Vec<Vec<bool>> = serde_json::from_value(steps).expect("steps");
    assert!(steps.len() > 10 && steps.iter().flatten().all(|good| *good), "{steps:?}");
}
