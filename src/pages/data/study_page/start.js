head();
convergence();
timeTable();
efficiencies();
strips();
costReport();
effects();
closing();
document.documentElement.dataset.ready = "true";
