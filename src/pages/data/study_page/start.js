head();
convergence();
timeTable();
efficiencies();
strips();
bill();
effects();
closing();
document.documentElement.dataset.ready = "true";
