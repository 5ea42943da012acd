// The socket to the server: JSON both ways, opened again after a loss, later each time.

const FIRST_MS = 500;
const LAST_MS = 8000;

export class Link {
  constructor(receive, change) {
    this.receive = receive;
    this.change = change;
    this.wait = FIRST_MS;
    this.stopped = false;
    this.open();
  }

  /** Opens no more once this connection is lost. */
  stop() {
    this.stopped = true;
  }

  get isOpen() {
    return this.socket?.readyState === WebSocket.OPEN;
  }

  open() {
    const scheme = location.protocol === "https:" ? "wss" : "ws";
    this.socket = new WebSocket(`${scheme}://${location.host}/ws${location.search}`); // In a frame the address has the token.
    this.socket.onopen = () => {
      this.wait = FIRST_MS;
      this.change("open", 0);
    };
    this.socket.onmessage = (event) => this.receive(JSON.parse(event.data));
    this.socket.onclose = () => {
      if (this.stopped) return;
      this.change("closed", this.wait);
      setTimeout(() => this.open(), this.wait);
      this.wait = Math.min(LAST_MS, this.wait * 2);
    };
  }

  send(type, fields = {}) {
    if (this.isOpen) this.socket.send(JSON.stringify({ type, ...fields }));
    return this.isOpen;
  }
}
