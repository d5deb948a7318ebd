// The steps of the tour: title, text, what a button does, and what to look at. Each in English and Portuguese. docs/tutorial.md goes deeper.
const fault = (part, last = 25) => ({ order: "break", fault: { ...part, at: 0, for: last } });
const T2_HIGH = fault({ do: "offset", sensor: "t2", size: 1.5 });
const T1_HIGH = fault({ do: "offset", sensor: "t1", size: 1.5 });
const CLOGGED = fault({ do: "clog", sensor: "t1", size: 0.85, lag: 0.4 });
const MORE_AIR = fault({ do: "air-flow", size: 1.26 }, 40);
const LESS_POWER = fault({ do: "heater-power", size: 0.75 }, 40);
const DRIFT = fault({ do: "drift", sensor: "t2", size: 4 }, 90);

export const STEPS = [
  {
    look: ".rig",
    title: ["A tube, a fan, a heater", "Um tubo, um ventilador, um aquecedor"],
    text: [
      "The fan blows room air over a heater and along a tube. T0 measures the room, T1 the air after the heater, T2 the same air a little later and cooler.\nThe controller reads T1 and sets the heater's power so that T1 stays at 35 °C. Follow the dotted line from T1 back to the heater: that is the loop.",
      "O ventilador sopra ar da sala por um aquecedor e ao longo de um tubo. T0 mede a sala, T1 o ar depois do aquecedor, T2 o mesmo ar um pouco depois e mais frio.\nO controlador lê T1 e ajusta a potência para que T1 fique a 35 °C. Siga a linha pontilhada de T1 ao aquecedor: é a malha.",
    ],
  },
  {
    look: ".charts",
    title: ["Why the power trembles", "Porque treme a potência"],
    text: [
      "The power is not steady: a small random square wave, the excitation, is added to it. Without it T1 and T2 would stand still, and nothing could be learnt from them of how the rig answers.\nDotted curves are what T1 and T2 should read by a model that knows the power alone.",
      "A potência não é constante: soma-se-lhe uma pequena onda quadrada aleatória, a excitação. Sem ela T1 e T2 ficariam parados e nada se aprenderia sobre a resposta da bancada.\nAs curvas pontilhadas são o que T1 e T2 deviam ler segundo um modelo que só conhece a potência.",
    ],
  },
  {
    look: ".say",
    title: ["A thermistor lies: T2", "Um termístor mente: T2"],
    text: [
      "T2 is outside the loop. Let it read 1.5 °C too high and watch: the orange curve leaves its dotted one, the blue one does not. Something that touches T2 alone must be T2.\nNote how soon the sentence stands, and how large it says the fault is; the diamond is the truth.",
      "T2 está fora da malha. Faça-o ler 1,5 °C a mais e veja: a curva laranja sai da pontilhada, a azul não. O que só toca em T2 tem de ser T2.\nRepare em quão cedo aparece a frase e que tamanho dá à falha; o losango é a verdade.",
    ],
    button: ["Let T2 lie", "Pôr T2 a mentir"],
    does: ["mend", T2_HIGH],
  },
  {
    look: ".charts",
    title: ["The loop hides a lie of T1", "A malha esconde a mentira de T1"],
    text: [
      "Now the same with T1. Its curve jumps for a moment and comes back to 35 °C, as if nothing were wrong: the controller believes it and heats less. The true air is 1.5 °C colder now, and only the power and T2 show it.\nThis is why a fault in a closed loop is looked for in what is left unexplained, not in the controlled temperature.",
      "Agora o mesmo com T1. A curva salta e volta a 35 °C, como se nada fosse: o controlador acredita e aquece menos. O ar está 1,5 °C mais frio, e só a potência e T2 o mostram.\nPor isso, em malha fechada, procura-se a falha no que fica por explicar, e não na temperatura controlada.",
    ],
    button: ["Let T1 lie", "Pôr T1 a mentir"],
    does: ["mend", T1_HIGH],
  },
  {
    look: ".charts",
    title: ["A residual", "Um resíduo"],
    text: [
      "“Measured less expected” is a residual: what the model cannot explain. While all is well it is noise around zero.\nAn offset of T2 shifts one residual. A change of the air shifts both, with a shape in time of its own. A residual says that something is wrong; their pattern says what.",
      "“Medido menos esperado” é um resíduo: o que o modelo não explica. Se tudo está bem, é ruído em torno de zero.\nUm desvio de T2 desloca um resíduo. Uma mudança do ar desloca ambos, com forma própria no tempo. Um resíduo diz que algo está errado; o padrão diz o quê.",
    ],
  },
  {
    look: ".charts",
    title: ["The paper's signatures", "As assinaturas do artigo"],
    text: [
      "Palma, Coito and Silva (2002) identify two small models on-line and watch five numbers: power (rap), T1 less T2 (ry12), the gains of both models (rsg1, rsg2), a bandwidth (rbw1). Each is below, within or above thresholds that were learnt from quiet operation.\nfdv says that there is a fault, fiv names it by a table of such patterns. For T2 too high: ry12 below, rsg2 above, the rest within. Try it again and read the pattern.",
      "Palma, Coito e Silva (2002) identificam dois modelos em linha e vigiam cinco números: potência (rap), T1 menos T2 (ry12), os ganhos dos modelos (rsg1, rsg2) e uma largura de banda (rbw1). Cada um está abaixo, dentro ou acima de limiares aprendidos sem falhas.\nfdv diz que há falha, fiv dá-lhe nome por uma tabela destes padrões. Para T2 a mais: ry12 abaixo, rsg2 acima, o resto dentro. Repita e leia o padrão.",
    ],
    button: ["Let T2 lie", "Pôr T2 a mentir"],
    does: ["mend", T2_HIGH],
  },
  {
    look: "aside",
    title: ["T1 is clogged", "T1 entupido"],
    text: [
      "Dirt on T1: it sees 15 % less of the rise, and later. Again the controller brings T1 back to 35 °C, by heating more. Everything behind gets hotter.\nThe bars say how much of what is unusual each hypothesis would explain by itself. Some others explain much of it, too; none explains as much.",
      "Sujidade em T1: vê 15 % menos da subida, e mais tarde. O controlador repõe T1 a 35 °C aquecendo mais, e tudo a jusante aquece.\nAs barras dizem quanto do invulgar cada hipótese explicaria sozinha. Outras também explicam muito; nenhuma tanto.",
    ],
    button: ["Clog T1", "Entupir T1"],
    does: ["mend", CLOGGED],
  },
  {
    look: ".charts",
    title: ["More air: why the paper is late", "Mais ar: porque o artigo tarda"],
    text: [
      "26 % more air cools everything. Within a second the likelihood diagnosis says “air or power”; some seconds later it has told the two apart. The paper's table waits for the bandwidth (rbw1) to rise; but an adapting model first follows the change itself and its bandwidth moves the wrong way, so fiv comes after ten seconds or more, in some runs never.\nWatch fdv come first, and fiv much later.",
      "26 % mais ar arrefece tudo. Num segundo a verosimilhança diz “caudal ou potência”; segundos depois distingue-os. A tabela do artigo espera que a largura de banda (rbw1) suba; mas um modelo adaptativo segue primeiro a própria mudança e a banda move-se ao contrário, e fiv só vem dez segundos depois ou mais, por vezes nunca.\nVeja fdv vir primeiro e fiv muito depois.",
    ],
    button: ["More air", "Mais ar"],
    does: ["mend", MORE_AIR],
  },
  {
    look: ".say",
    title: ["What looks alike", "O que se parece"],
    text: [
      "A weaker heater cools as more air does. For the first moments nothing can tell the two apart, and it says so: “air or power”. Then the time constants decide: air that moves faster answers faster, a weak heater does not.\nWhat cannot be told apart is not hidden; docs/diagnosis.md has the list.",
      "Um aquecedor mais fraco arrefece como mais ar. Nos primeiros instantes nada os distingue, e ele di-lo: “caudal ou potência”. Depois decidem as constantes de tempo: com mais ar a resposta é mais rápida, com menos potência não.\nO que não se distingue não é escondido; docs/diagnosis.md tem a lista.",
    ],
    button: ["Weaken the heater", "Enfraquecer o aquecedor"],
    does: ["mend", LESS_POWER],
  },
  {
    look: ".charts",
    title: ["Slow faults", "Falhas lentas"],
    text: [
      "A drift of 4 °C a minute begins with nothing at all. At 10× you wait less. A detector that forgets, or a model that adapts, would learn the drift as normal; so the model here is frozen, and the state is held against the learnt one over a minute.",
      "Uma deriva de 4 °C por minuto começa com nada. A 10× espera menos. Um detetor que esquece, ou um modelo que se adapta, tomaria a deriva por normal; por isso aqui o modelo está congelado e o estado é comparado com o aprendido durante um minuto.",
    ],
    button: ["Let T2 drift", "Pôr T2 a derivar"],
    does: ["mend", DRIFT],
  },
  {
    look: ".say",
    title: ["False alarms against delay", "Falsos alarmes contra atraso"],
    text: [
      "A lower threshold sees faults sooner and cries wolf more often. There is no way around it, only models that leave less unexplained. Choose “lively” surroundings below and watch the residuals: the same threshold is worth less there.\nThe campaigns of this project count both over thousands of hours (docs/diagnosis.md).",
      "Um limiar mais baixo vê as falhas mais cedo e dá mais falsos alarmes. Não há volta a dar, só modelos que deixem menos por explicar. Escolha ambiente “agitado” em baixo e veja os resíduos: o mesmo limiar vale menos.\nAs campanhas deste projeto contam ambos ao longo de milhares de horas (docs/diagnosis.md).",
    ],
  },
  {
    look: ".rig",
    title: ["Safety is another matter", "A segurança é outra coisa"],
    text: [
      "The diagnosis warns; what switches off is the supervisor. Break the wire of T1: the controller is blind, and the heater goes off on the spot. Mend it, acknowledge, arm: it learns anew.",
      "O diagnóstico avisa; quem desliga é o supervisor. Parta o fio de T1: o controlador fica cego e o aquecedor desliga-se logo. Repare, confirme, arme: volta a aprender.",
    ],
    button: ["Break T1's wire", "Partir o fio de T1"],
    does: ["mend", fault({ do: "open", sensor: "t1" }, 5)],
  },
  {
    look: "#modes",
    title: ["Your turn", "A sua vez"],
    text: [
      "In the quiz something breaks, and the names are hidden. Read the residuals, name it before the instrument's score grows. Exercises with answers are in docs/tutorial.md.",
      "No desafio algo avaria e os nomes ficam escondidos. Leia os resíduos e diga o nome antes que a pontuação do instrumento cresça. Exercícios com respostas em docs/tutorial.md.",
    ],
    button: ["Surprise me", "Surpreenda-me"],
    does: ["surprise"],
  },
];
