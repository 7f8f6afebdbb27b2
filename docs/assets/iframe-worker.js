// The search runs in a worker. No browser starts a worker from a file, so where the site is opened as files,
// its script runs in a hidden frame. The theme looks for this by the name IFrameWorker.
if (location.protocol === "file:") {
  window.Worker = window.IFrameWorker = class extends EventTarget {
    constructor(url) {
      super()
      const frame = document.createElement("iframe")
      frame.hidden = true
      const inside = `
        postMessage = data => frameElement.worker.dispatchEvent(new MessageEvent("message", { data }))
        importScripts = (...urls) => urls.reduce((before, url) => before.then(() => new Promise(done => {
          document.head.append(Object.assign(document.createElement("script"), { src: url, onload: done }))
        })), Promise.resolve())`
      frame.srcdoc = `<!doctype html><head><script>${inside}<\/script><script src="${url}"><\/script></head>`
      frame.worker = this
      this.ready = new Promise(done => frame.addEventListener("load", () => done(frame.contentWindow)))
      document.body.append(frame)
    }
    postMessage(data) {
      this.ready.then(within => within.dispatchEvent(new within.MessageEvent("message", { data })))
    }
  }
}
