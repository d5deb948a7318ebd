//! The bridge with a broker of a few lines, which does as it is told.

use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};

use bytes::BytesMut;
use fdi_core::schema;
use pt326_lab::scene::{Order, Scene};
use pt326_lab::session::Session;
use rumqttc::{ConnAck, ConnectReturnCode, PubAck, Publish, SubAck, SubscribeReasonCode, UnsubAck};

use serde_json::json;

use super::*;
use crate::clock;
use crate::source::scripted::Scripted;
use crate::source::{Numbers, Source, Told};

const MOST: usize = 1 << 20;

fn row(mode: f32, trip: f32) -> Told {
    let mut row: Numbers = [f32::NAN; _];
    for (name, number) in [("mode", mode), ("trip", trip), ("alarm", 0.0), ("advice", 0.0)] {
        row[schema::field(name).unwrap()] = number;
    }
    Told::Row(row)
}

/// One connection of the bridge, from the broker's end.
struct Peer {
    stream: TcpStream,
    bytes: BytesMut,
}

impl Peer {
    /// Waits for the bridge; tells it whether its last session is remembered.
    fn accept(listener: &TcpListener, remembers: bool) -> Self {
        let (stream, _) = listener.accept().unwrap();
        stream.set_read_timeout(Some(Duration::from_secs(60))).unwrap();
        let mut peer = Self { stream, bytes: BytesMut::new() };
        let Packet::Connect(connect) = peer.packet() else { panic!("no greeting") };
        let will = connect.last_will.unwrap();
        assert_eq!(
            (&*will.topic, &will.message[..], will.retain),
            ("pt326/bench/availability", &b"lost"[..], true)
        );
        peer.send(&Packet::ConnAck(ConnAck::new(ConnectReturnCode::Success, remembers)));
        peer
    }

    fn send(&mut self, packet: &Packet) {
        let mut bytes = BytesMut::new();
        packet.write(&mut bytes, MOST).unwrap();
        self.stream.write_all(&bytes).unwrap();
    }

    fn packet(&mut self) -> Packet {
        loop {
            if let Ok(packet) = Packet::read(&mut self.bytes, MOST) {
                return packet;
            }
            let mut some = [0; 4096];
            let n = self.stream.read(&mut some).unwrap();
            assert!(n > 0, "the bridge has gone");
            self.bytes.extend_from_slice(&some[..n]);
        }
    }

    /// The next packet that is no state and no ping.
    fn said(&mut self) -> Packet {
        loop {
            match self.packet() {
                Packet::PingReq => self.send(&Packet::PingResp),
                Packet::Publish(message) if message.topic.ends_with("/state") => {}
                packet => return packet,
            }
        }
    }

    /// The next message under one of the ends of a topic, acknowledged as all before it. It must come within a hundred others.
    fn message(&mut self, ends: &[&str]) -> Value {
        for _ in 0..100 {
            match self.packet() {
                Packet::PingReq => self.send(&Packet::PingResp),
                Packet::Subscribe(asked) => self.send(&Packet::SubAck(SubAck::new(
                    asked.pkid,
                    vec![SubscribeReasonCode::Success(QoS::AtMostOnce)],
                ))),
                Packet::Unsubscribe(asked) => self.send(&Packet::UnsubAck(UnsubAck::new(asked.pkid))),
                Packet::Publish(message) => {
                    if message.qos == QoS::AtLeastOnce {
                        assert!(message.retain, "{}", message.topic);
                        self.send(&Packet::PubAck(PubAck::new(message.pkid)));
                    }
                    if ends.iter().any(|end| message.topic == format!("pt326/bench/{end}")) {
                        return serde_json::from_slice(&message.payload).unwrap();
                    }
                }
                _ => {}
            }
        }
        panic!("nothing comes under {ends:?}");
    }

    fn command(&mut self, payload: &str, retain: bool) -> Value {
        let mut publish = Publish::new("pt326/bench/command", QoS::AtMostOnce, payload);
        publish.retain = retain;
        self.send(&Packet::Publish(publish));
        self.message(&["answer"])
    }
}

fn broker(port: u16, commands: bool) -> Broker {
    let broker = Broker::new(&format!("mqtt://127.0.0.1:{port}/bench"), None, commands).unwrap();
    Broker { pause: Duration::from_millis(1), ..broker }
}

fn bridged(source: impl Source, commands: bool) -> TcpListener {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = listener.local_addr().unwrap().port();
    start(clock::start(source, 1.0).unwrap(), broker(port, commands), |_| ()).unwrap();
    listener
}

/// The broker goes, with a message that it has not acknowledged, and comes back, twice: each trip is told, and none twice.
#[test]
fn a_broker_that_comes_back_hears_what_it_has_missed_once() {
    let (rig, tell, _orders) = Scripted::new(0.11);
    let listener = bridged(rig, false);
    let mut told = Vec::new();
    let number = |message: &Value| message["number"].as_u64().unwrap();
    tell.send(row(3.0, f32::NAN)).unwrap();
    let mut first = Peer::accept(&listener, false);
    told.push(number(&first.message(&["trip"])));
    drop(first);
    let mut second = Peer::accept(&listener, true);
    for row in [row(4.0, 1.0), row(3.0, f32::NAN), row(4.0, 2.0)] {
        tell.send(row).unwrap();
    }
    // The greeting is acknowledged, the trip is not.
    loop {
        match second.said() {
            Packet::Publish(message) if message.topic.ends_with("/trip") => break,
            Packet::Publish(message) => second.send(&Packet::PubAck(PubAck::new(message.pkid))),
            _ => {}
        }
    }
    drop(second);
    let mut third = Peer::accept(&listener, true);
    told.extend((0..3).map(|_| number(&third.message(&["trip"]))));
    tell.send(row(3.0, f32::NAN)).unwrap();
    told.push(number(&third.message(&["trip"])));
    assert_eq!(told, [1, 2, 3, 4, 5]);
    drop(third);
    let mut forgets = Peer::accept(&listener, false);
    assert_eq!(number(&forgets.message(&["trip"])), 5, "the last is said again to one that forgot");
}

/// Whatever comes: nothing but a stop or a set-point within bounds reaches the rig.
#[test]
fn no_message_reaches_the_rig_but_stop_and_a_set_point_within_bounds() {
    let (rig, _tell, orders) = Scripted::new(0.11);
    let mut peer = Peer::accept(&bridged(rig, true), false);
    let elsewhere = Publish::new("pt326/other/command", QoS::AtMostOnce, r#"{"command":"stop"}"#);
    peer.send(&Packet::Publish(elsewhere));
    for order in
        ["arm", "tune", "acknowledge", "shelve", "relearn", "accept", "excite", "fan", "set", "console"]
    {
        for payload in [
            format!(r#"{{"command":"{order}"}}"#),
            format!(r#"{{"command":"order","order":{{"order":"{order}"}}}}"#),
        ] {
            assert_eq!(peer.command(&payload, false)["type"], "refused", "{payload}");
        }
    }
    let too_hot = peer.command(r#"{"command":"setpoint","celsius":500}"#, false);
    assert!(
        too_hot["why"].as_str().unwrap().contains("set-point 500 degC refused, expected 20 to 60 degC"),
        "{too_hot}"
    );
    assert_eq!((&too_hot["code"], &too_hot["values"]["max"]), (&json!("setpoint"), &json!(60.0)));
    let retained = peer.command(r#"{"command":"setpoint","celsius":36}"#, true);
    assert!(retained["why"].as_str().unwrap().contains("without the retain flag"), "{retained}");
    assert_eq!(peer.command(r#"{"command":"setpoint","celsius":36}"#, false)["type"], "done");
    assert_eq!(peer.command(r#"{"command":"stop"}"#, false)["type"], "done");
    assert_eq!(orders.try_iter().collect::<Vec<_>>(), [Order::Setpoint { celsius: 36.0 }, Order::Stop]);
}

/// The same of the instrument itself: one that is off stays off, whatever set-point it is given.
#[test]
fn a_rig_that_is_off_heats_for_no_message() {
    let session = Session::new(Scene { orders: Vec::new(), ..Scene::default() }).unwrap();
    let mut peer = Peer::accept(&bridged(session, true), false);
    for payload in [
        r#"{"command":"arm"}"#,
        r#"{"command":"setpoint","celsius":60}"#,
        r#"{"command":"setpoint","celsius":500}"#,
    ] {
        peer.command(payload, false);
    }
    let begun = peer.message(&["state"])["tick"].as_f64().unwrap();
    loop {
        let state = peer.message(&["state"]);
        assert_eq!(
            (&state["mode"], &state["drive"], &state["setpoint"]),
            (&json!("off"), &json!(0.0), &json!(60.0))
        );
        if state["tick"].as_f64().unwrap() > begun {
            break;
        }
    }
}

/// A session that the broker remembers may have asked for commands once.
#[test]
fn by_default_no_commands_are_asked_for_nor_taken() {
    let (rig, _tell, orders) = Scripted::new(0.11);
    let mut peer = Peer::accept(&bridged(rig, false), true);
    let asked = loop {
        match peer.said() {
            Packet::Publish(message) => peer.send(&Packet::PubAck(PubAck::new(message.pkid))),
            asked => break asked,
        }
    };
    assert!(
        matches!(&asked, Packet::Unsubscribe(topics) if topics.topics == ["pt326/bench/command"]),
        "{asked:?}"
    );
    let (other, _tell, others) = Scripted::new(0.11);
    let bridge = Bridge::new(clock::start(other, 1.0).unwrap(), broker(1, false), Box::new(|_| ()));
    let runtime = tokio::runtime::Builder::new_current_thread().build().unwrap();
    let answer = runtime.block_on(bridge.answer(br#"{"command":"stop"}"#, false));
    assert_eq!(answer["why"], "no commands are taken here");
    assert_eq!((orders.try_iter().count(), others.try_iter().count()), (0, 0));
}

#[test]
fn an_address_says_what_it_lacks() {
    let broker = Broker::new("mqtt://anna@[::1]:1884/bench-1", Some("secret".into()), false).unwrap();
    assert_eq!((&*broker.host, broker.port, &*broker.name), ("::1", 1884, "bench-1"));
    assert_eq!(broker.login, Some(("anna".into(), "secret".into())));
    let plain = Broker::new("mqtt://broker.local", None, true).unwrap();
    assert_eq!(
        (plain.of("lab-2").name, broker.of("lab-2").topic("state")),
        ("lab-2".into(), "pt326/bench-1-lab-2/state".into())
    );
    assert_eq!((plain.port, &*plain.name, plain.login), (1883, "rig", None));
    for (url, why) in [
        ("broker.local", "expected mqtt://"),
        ("http://broker.local", "expected mqtt://"),
        ("mqtts://broker.local", "no encryption"),
        ("mqtt://anna:secret@broker.local", "PT326_MQTT_PASSWORD"),
        ("mqtt://broker.local/a/b", "letters, digits"),
        ("mqtt://broker.local/+", "letters, digits"),
        ("mqtt:///bench", "expected mqtt://"),
    ] {
        let error = format!("{:#}", Broker::new(url, None, false).unwrap_err());
        assert!(error.contains(why), "{url}: {error}");
    }
}
