// The words that only the wall has, in each language of the page.
export default {
  en: {
    title: "{count} rigs", stop_all: "Stop all", stops: "Stopping all …", stopped: "The stop was passed on to all {count} rigs.",
    not_stopped: "NOT stopped, go there and press the button of the board: {what}", no_stop: "The stop did NOT go out: pt326 live does not answer. Press the buttons of the boards.",
    absent: "Not there yet", gone: "No connection to pt326 live: what you see is old. The boards go on regulating, and trip by themselves.",
    t0: "T0", t1: "T1", t2: "T2", power: "Power", setpoint: "set-point {x} °C", theme: "Light or dark", close: "Close",
    alarm: "in alarm", tripped: "tripped", advice: "with advice", lost: "lost", learn: "preparing", off: "off", monitor: "in order",
  },
  pt: {
    title: "{count} instalações", stop_all: "Parar todas", stops: "A parar todas …", stopped: "A paragem foi transmitida às {count} instalações.",
    not_stopped: "NÃO pararam, vá lá e carregue no botão da placa: {what}", no_stop: "A paragem NÃO saiu: pt326 live não responde. Carregue nos botões das placas.",
    absent: "Ainda não está presente", gone: "Sem ligação a pt326 live: o que se vê é antigo. As placas continuam a regular e disparam sozinhas.",
    t0: "T0", t1: "T1", t2: "T2", power: "Potência", setpoint: "referência {x} °C", theme: "Claro ou escuro", close: "Fechar",
    alarm: "em alarme", tripped: "disparada", advice: "em aviso", lost: "sem ligação", learn: "a preparar", off: "desligada", monitor: "em ordem",
  },
};
